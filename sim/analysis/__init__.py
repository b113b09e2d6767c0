"""Reading results: estimates with intervals, paired comparisons, tables, the HTML report.

Imports evaluation, task and the rooms below them."""
