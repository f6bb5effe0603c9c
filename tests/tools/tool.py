"""What the tools that remesh many files have in common: the files, the program, and tables in Markdown."""

import argparse
import pathlib
import shutil
import sys

import surface_files


def say(text):
    """What a tool is doing goes to standard error; the tables alone go to standard output."""
    print(text, file=sys.stderr, flush=True)


def print_table(table):
    """`table`: rows of cells, of which the first are the titles."""
    table = [[cell.replace("|", "\\|") for cell in row] for row in table]
    widths = [max(len(row[column]) for row in table) for column in range(len(table[0]))]
    table.insert(1, ["-" * width for width in widths])
    for row in table:
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")


def make_parser(description, defaults):
    """`defaults`: the options for remesh that are used if none are given."""
    by_default = "; by default: " + " ".join(defaults) if defaults else ""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog=f"What follows -- are options for remesh{by_default}.")
    parser.add_argument("--remesh", default="build/release/remesh", help="the program; by default %(default)s")
    parser.add_argument("--time-limit", type=float, default=120, metavar="S", help="for each run (%(default)s)")
    return parser


def parse(parser, arguments, defaults, corpus):
    """The arguments; `files` are the surfaces below the paths (or `corpus`), and `options` what follows `--`."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    asked = parser.parse_args(arguments[:end])
    asked.options = arguments[end + 1:] or defaults
    program = shutil.which(asked.remesh)
    if program is None:
        parser.error(f"there is no program {asked.remesh}; --remesh says where it is")
    asked.remesh = str(pathlib.Path(program).resolve())
    asked.files = []
    for path in map(pathlib.Path, asked.paths or corpus):
        found = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        asked.files += [p for p in found if surface_files.is_surface_file(p)]
    if not asked.files:
        parser.error("no OBJ, OFF, PLY or STL file there")
    return asked
