"""What most tests begin with."""

import aerodeck
import pytest


@pytest.fixture(scope="session")
def table():
    return aerodeck.Derivatives.deck("LN21-5200")


@pytest.fixture(scope="session")
def section():
    return aerodeck.Section.table_4_1()


@pytest.fixture(scope="session")
def model(table):
    return aerodeck.fit_laguerre(table)
