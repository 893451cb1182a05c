"""Writes wide_table.xls and wide_table.ods: one sheet with a title, names, units and invented figures, for the tests of the reader.

    python3 make_old_workbooks.py        (needs xlwt and odfpy)

Row r of the reduced velocity V* holds 4 + 2 r, column c of a derivative (c + 1) + (r + 1) / 100.
"""

from pathlib import Path

import xlwt
from odf.opendocument import OpenDocumentSpreadsheet
from odf.table import Table, TableCell, TableRow
from odf.text import P

HERE = Path(__file__).parent
NAMES = ["V*", "H1*", "H2*", "H3*", "H4*", "A1*", "A2*", "A3*", "A4*"]
ROWS = [["Invented figures"], NAMES, ["[-]"] * len(NAMES)]
ROWS += [[4 + 2 * r] + [c + 1 + (r + 1) / 100 for c in range(8)] for r in range(4)]

book = xlwt.Workbook()
sheet = book.add_sheet("Derivatives")
for r, row in enumerate(ROWS):
    for c, value in enumerate(row):
        sheet.write(r, c, value)
book.save(str(HERE / "wide_table.xls"))

document = OpenDocumentSpreadsheet()
table = Table(name="Derivatives")
for row in ROWS:
    line = TableRow()
    for value in row:
        if isinstance(value, str):
            cell = TableCell(valuetype="string")
        else:
            cell = TableCell(valuetype="float", value=repr(value))
        cell.addElement(P(text=str(value)))
        line.addElement(cell)
    table.addElement(line)
document.spreadsheet.addElement(table)
document.save(str(HERE / "wide_table.ods"))
