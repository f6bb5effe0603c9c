"""Remeshes a file: python -m remeshd part.stl out.obj min_angle_deg=30"""

from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, Dict, List, Optional

from . import Cancelled, Client, Problem


def main(arguments: Optional[List[str]] = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m remeshd", description="Remeshes a file by a service.")
    parser.add_argument("input", help="the mesh to read")
    parser.add_argument("output", nargs="?", help="the mesh to write; without it, the report of the input is printed")
    parser.add_argument("option", nargs="*", help="an option of the service, such as min_angle_deg=30")
    parser.add_argument("--url", default="http://localhost:8080", help="the address of the service (%(default)s)")
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    given = parser.parse_args(arguments)
    options: Dict[str, Any] = {}
    for text in given.option:
        name, equals, value = text.partition("=")
        if not equals:
            parser.error(f"an option such as min_angle_deg=30 was expected, not {text}")
        options[name] = value
    client = Client(given.url, api_key=os.environ.get("REMESH_API_KEY"))
    try:
        if given.output is None:
            print(json.dumps(client.analyze(given.input, **options), indent=1))
        else:
            client.remesh_file(given.input, given.output, progress=not given.quiet and sys.stderr.isatty(), **options)
    except (Problem, OSError) as error:
        print(f"remeshd: {error}", file=sys.stderr)
        return 1
    except (KeyboardInterrupt, Cancelled):
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
