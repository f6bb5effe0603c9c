"""The one table that bench.py writes."""

import json


class Table:
    def __init__(self):
        self.rows = []

    def add(self, case, what, value, unit, against=None, base=None, bound=None):
        """A figure and, beside another one, the ratio that counts. The bound is on the ratio, or without one on the
        figure."""
        self.rows.append({"case": case, "what": what, "value": float(f"{value:.6g}"), "unit": unit, "against": against,
                          "ratio": round(value / base, 3) if base else None, "bound": bound})

    def leave_out(self, case, what, reason):
        self.rows.append({"case": case, "what": what, "value": None, "unit": f"not measured: {reason}", "against": None,
                          "ratio": None, "bound": None})

    def above_bounds(self):
        return [row for row in self.rows if row["bound"] is not None and row[what_counts(row)] > row["bound"]]

    def markdown(self):
        lines = ["| case | what | median | against | ratio | bound |", "| --- | --- | ---: | --- | ---: | ---: |"]
        above = self.above_bounds()
        for row in self.rows:
            value = row["unit"] if row["value"] is None else f"{digits(row['value'])} {row['unit']}"
            ratio = "" if row["ratio"] is None else f"{row['ratio']:.2f}"
            if row in above and what_counts(row) == "ratio":
                ratio = f"**{ratio}**"
            elif row in above:
                value = f"**{value}**"
            bound = "" if row["bound"] is None else f"{row['bound']}"
            lines.append(f"| {row['case']} | {row['what']} | {value} | {row['against'] or ''} | {ratio} | {bound} |")
        return "\n".join(lines) + "\n"

    def write(self, folder):
        (folder / "table.md").write_text(self.markdown())
        (folder / "table.json").write_text(json.dumps(self.rows, indent=2) + "\n")


def what_counts(row):
    return "value" if row["ratio"] is None else "ratio"


def digits(value):
    return f"{value:,.0f}" if value >= 1000 else f"{value:.4g}"
