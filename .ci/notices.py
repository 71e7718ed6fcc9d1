#!/usr/bin/env python3
"""Writes src/third_party_notices.txt: the licences of everything that the program contains.

Usage: .ci/notices.py [--check]

--check writes nothing and fails if the file is not what would be written.
Texts are those that the crates bring along; several crates with the same text share it.
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOTICES = ROOT / "src" / "third_party_notices.txt"
TARGETS = ["x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu"]
# Where a crate leaves the choice, the first of these that it offers.
PREFERRED = ["MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "Zlib", "CC0-1.0", "Unlicense"]
LICENCE_FILE = re.compile(r"(licen[sc]e|copying|unlicense)", re.IGNORECASE)

MIT = """\
Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
documentation files (the "Software"), to deal in the Software without restriction, including without limitation
the rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and
to permit persons to whom the Software is furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all copies or substantial portions of
the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO
THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF
CONTRACT, TORT OR OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS
IN THE SOFTWARE.
"""

HEADING = """\
Third-party notices

The flythrough program contains the following software and font. Each licence stands below the names of what
is used under it. This file is written by .ci/notices.py.
"""


def cargo(*arguments):
    command = ["cargo", *arguments, "--locked"]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def crates():
    """Crates whose code the program contains: neither what only builds or tests it nor procedural macros."""
    targets = [argument for target in TARGETS for argument in ("--target", target)]
    tree = cargo("tree", "--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}", *targets)
    used = {tuple(line.split()[:2]) for line in tree.splitlines() if line.strip()}
    metadata = json.loads(cargo("metadata", "--format-version", "1"))
    for package in metadata["packages"]:
        if (package["name"], "v" + package["version"]) in used and package["source"]:
            yield package


def licence_files(package):
    """The files of one of the licences that the crate may be used under."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(file for file in folder.iterdir() if file.is_file() and LICENCE_FILE.match(file.name))
    if package["license_file"] and not files:
        files = [folder / package["license_file"]]
    expression = package["license"] or ""
    if " AND " in expression or len(files) < 2:
        return files
    offered = [licence for licence in PREFERRED if re.search(rf"\b{re.escape(licence)}\b", expression)]
    for licence in offered:
        chosen = [file for file in files if licence.split("-")[0].lower() in file.name.lower()]
        if chosen:
            return chosen
    return files


def text_of(package):
    """The texts of the crate's licence; if it brings none along, the MIT licence with its authors' names."""
    files = licence_files(package)
    if files:
        texts = [file.read_text(encoding="utf-8", errors="replace") for file in files]
        return "\n".join(tidy(text) for text in texts)
    name = package["name"]
    if "MIT" not in (package["license"] or ""):
        sys.exit(f"{name}: has no licence file and is not under MIT; add its text to .ci/notices.py")
    authors = ", ".join(re.sub(r" <.*", "", author) for author in package["authors"])
    return f"Copyright (c) {authors or f'the {name} developers'}\n\n{MIT}"


def tidy(text):
    lines = [line.rstrip() for line in text.replace("\f", "").splitlines()]
    return "\n".join(lines).strip("\n") + "\n"


def notices():
    names = defaultdict(list)
    for package in crates():
        names[text_of(package)].append(f"{package['name']} {package['version']} ({package['license']})")
        if package["name"] == "notosans":
            font = Path(package["manifest_path"]).parent / "fonts" / "LICENSE_OFL.txt"
            names[tidy(font.read_text(encoding="utf-8"))].append("Noto Sans (font, OFL-1.1)")
    standard = f"Copyright (c) The Rust Project Contributors\n\n{MIT}"
    names[standard].append("Rust standard library (MIT OR Apache-2.0)")
    parts = [HEADING]
    for text, users in sorted(names.items(), key=lambda item: sorted(item[1])):
        parts.append("-" * 80 + "\n" + "\n".join(sorted(users)) + "\n\n" + text)
    return "\n".join(parts)


def main():
    text = notices()
    if sys.argv[1:] == ["--check"]:
        if NOTICES.read_text(encoding="utf-8") != text:
            sys.exit(f"{NOTICES.relative_to(ROOT)} is not of these crates; run .ci/notices.py")
        print(f"{NOTICES.relative_to(ROOT)} is of the crates that the program contains")
    else:
        NOTICES.write_text(text, encoding="utf-8")


main()
