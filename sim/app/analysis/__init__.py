"""Reading results: estimates with intervals, paired comparisons, tables, the HTML report."""
