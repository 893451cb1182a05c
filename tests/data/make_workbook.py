"""Writes workbook.xlsx: a small workbook in the NTNU layout with invented figures, for the tests of the reader.

    python3 make_workbook.py        (needs openpyxl)

Two speeds (4 and 8 m/s), frequencies 0.5, 1 and 2 Hz, width 0.5 m; column c, row r of the derivatives holds
(c + 1) + (r + 1) / 100, with alternating sign. The sheets stand in another order than in the text of the reader.
"""

import math
from pathlib import Path

from openpyxl import Workbook

NAMES = [f"{force}{i}" for force in "PHA" for i in range(1, 7)]
SPEEDS = [4.0, 4.01, 4.02, 8.0, 8.01, 8.02]
FREQUENCIES = [0.5, 1.0, 2.0] * 2
WIDTH = 0.5


def sheet(book, title, prefix, value):
    page = book.create_sheet(title)
    page.append([prefix + name for name in NAMES])
    for row in range(len(SPEEDS)):
        page.append([value(column, row) for column in range(len(NAMES))])


book = Workbook()
book.remove(book.active)
sheet(book, "Aerodynamic Derivatives", "", lambda c, r: (-1) ** c * (c + 1 + (r + 1) / 100))
sheet(book, "Mean wind velocity", "MeanWind_", lambda c, r: SPEEDS[r] + c / 1000)
sheet(
    book,
    "Reduced Velocities",
    "Vred_",
    lambda c, r: (SPEEDS[r] + c / 1000) / (2 * math.pi * FREQUENCIES[r] * WIDTH),
)
book.save(Path(__file__).with_name("workbook.xlsx"))

# The same with one fault each.
cell = book["Reduced Velocities"]["I4"]  # H3, third point
good = cell.value
for name, bad in [("text", "n/a"), ("empty", None), ("negative", -good)]:
    cell.value = bad
    book.save(Path(__file__).with_name(f"workbook_{name}.xlsx"))
cell.value = good
book["Reduced Velocities"]["I1"].value = "Vred_H33"
book.save(Path(__file__).with_name("workbook_no_column.xlsx"))
book["Reduced Velocities"]["I1"].value = "Vred_H3"
book["Mean wind velocity"].title = "Wind"
book.save(Path(__file__).with_name("workbook_no_sheet.xlsx"))
