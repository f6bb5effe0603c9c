"""Draws which wings of the core include which, for core/README.md.

usage: include_graph.py [--check] SVG

Wings stand in the order of include_order.txt, the lowest at the bottom. An arc on the right leads from a wing down to one
that it includes, broader by one for each factor of four in the number of includes. An include that goes up would be an arc in red on the left.
With --check nothing is written. Exit code 1: the file is not the one that would be drawn.
"""

import collections
import math
import sys

import check

BOX_WIDTH, BOX_HEIGHT, GAP, LEFT, TOP = 230, 34, 14, 60, 16
WIDTH = 500
PURPOSE = {
    "core": "remesh: the list of stages",
    "core/base": "numbers, errors, threads",
    "core/mesh": "surfaces and their edges",
    "core/geometry": "predicates, trees, planes",
    "core/io": "mesh files",
    "core/triangulation": "a polygon's triangles",
    "core/patch_types": "what a patch is",
    "core/mending": "welding and repair",
    "core/patches": "planes, patches, loops",
    "core/refinement": "angles and sizes",
    "core/verify": "the independent check",
    "core/output": "assembly and report",
}


def count_includes(root, order):
    counts = collections.Counter()
    for path, _, header in check.includes(root, order):
        here, there = check.place(order, path), check.place(order, header)
        if there is not None and there != here:
            counts[here, there] += 1
    return counts


def draw(root):
    # A wing stands where the first of its folders does.
    folders = [folder for folder in check.entries("include_order.txt") if folder.split("/")[0] == "core"]
    order = list(dict.fromkeys("/".join(folder.split("/")[:2]) for folder in folders))
    counts = count_includes(root, order)
    top_of = {i: TOP + (len(order) - 1 - i) * (BOX_HEIGHT + GAP) for i in range(len(order))}
    height = TOP * 2 + len(order) * (BOX_HEIGHT + GAP) - GAP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}">',
        f'<rect width="{WIDTH}" height="{height}" rx="8" fill="#ffffff"/>',
        '<g font-family="Helvetica,Arial,sans-serif" font-size="13">',
    ]
    for (here, there), count in sorted(counts.items()):
        is_down = there < here
        side = LEFT + BOX_WIDTH if is_down else LEFT
        reach = 20 + 22 * abs(here - there)
        bend = side + reach if is_down else side - reach
        # Arcs leave a box above its middle and reach one below its middle, so that they can be told apart.
        start = top_of[here] + BOX_HEIGHT * 0.65
        end = top_of[there] + BOX_HEIGHT * 0.35
        colour = "#4b716b" if is_down else "#d02020"
        parts.append(
            f'<path d="M{side} {start:.1f}C{bend:.1f} {start:.1f} {bend:.1f} {end:.1f} {side} {end:.1f}" fill="none" '
            f'stroke="{colour}" stroke-opacity="0.55" stroke-width="{1 + math.floor(math.log(count, 4))}"/>'
        )
    for i, folder in enumerate(order):
        y = top_of[i]
        name = folder.removeprefix("core/") if folder != "core" else "remesh"
        purpose = PURPOSE.get(folder, "").removeprefix("remesh: ")
        parts.append(
            f'<rect x="{LEFT}" y="{y}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="5" fill="#e4f4ea" stroke="#4b716b"/>'
            f'<text x="{LEFT + 10}" y="{y + 15}" font-weight="bold" fill="#20403a">{name}</text>'
            f'<text x="{LEFT + 10}" y="{y + 29}" font-size="11" fill="#405a55">{purpose}</text>'
        )
    parts.append("</g>\n</svg>\n")
    return "\n".join(parts)


def main():
    arguments = sys.argv[1:]
    is_check = "--check" in arguments
    path = [a for a in arguments if a != "--check"][0]
    drawing = draw(check.ROOT)
    if is_check:
        with open(path, encoding="utf-8") as file:
            if file.read() != drawing:
                print(f"{path} does not show the includes as they are; ./dev figures draws it again")
                return 1
        return 0
    with open(path, "w", encoding="utf-8") as file:
        file.write(drawing)
    return 0


if __name__ == "__main__":
    sys.exit(main())
