"""Proposes entries for the list: constants, comparisons, signs, conditions and steps of a folder's files, one change each.

The rule still has to be written by whoever takes a proposal over: what no one can say in words is no rule.
"""
import random
import re

from . import entries

NUMBER = re.compile(r"(?<![\w.\"])(\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+|[1-9]\d*)(?![\w.\"])")
SKIP = re.compile(r"^(//|#|\}|namespace|using|template|public:|private:|static_assert|HWY_|throw|assert)|std::invalid_argument|^\s*$")


def number_changes(line):
    for found in NUMBER.finditer(line):
        text = found[1]
        value = float(text)
        if value == 0:
            continue
        before, after = line[:found.start()], line[found.end():]
        if re.search(r"[\[<]\s*$", before) or re.match(r"\s*[\]>]", after):
            continue  # an index or a template's argument
        for changed in ((f"{text}e6", f"{text}e-6") if re.search(r"[.e]", text) else (str(int(value) * 1000), "0")):
            if "e" in text and "e" in changed[len(text):]:
                changed = f"({text} * {changed[len(text):].replace('e', '1e')})"
            yield f"{text} is {changed}", before + changed + after


def line_changes(line):
    """(what is changed, the changed line) of one line of code."""
    code = line.split("//")[0].rstrip()
    yield from number_changes(code)
    for old, new in ((" < ", " > "), (" > ", " < "), (" <= ", " > "), (" >= ", " < "), (" == ", " != "), (" != ", " == "), (" && ", " || "),
                     (" || ", " && "), (" + ", " - "), (" - ", " + "), (" * ", " / "), (" += ", " -= "), ("std::min(", "std::max("),
                     ("std::max(", "std::min("), (".inverse()", ""), ("if (!", "if ("), (" = true", " = false"), (" = false", " = true"),
                     ("std::abs(", "(")):
        for found in re.finditer(re.escape(old), code):
            if "template" in code or "operator" in code or (old in (" < ", " > ") and re.search(r"<\w+ >", code)):
                continue
            yield f"'{old.strip()}' is '{new.strip()}'", code[:found.start()] + new + code[found.end():]
    found = re.match(r"(\s*(?:\} else )?if \()(.*)(\) (?:return|continue|break)\b.*;|\) \{)$", code)
    if found and ";" not in found[2]:
        yield "never", f"{found[1]}false && ({found[2]}){found[3]}"
        yield "always", f"{found[1]}true || ({found[2]}){found[3]}"
    if re.match(r"\s*[\w.>\-\[\]:]+\(.*\);$", code) or re.match(r"\s*[\w.\[\]]+ [-+*/]?= .*;$", code):
        yield "left out", "// " + code.strip()


def proposals(path, name):
    lines = path.read_text().splitlines()
    stripped = [line.strip() for line in lines]
    for k, line in enumerate(stripped):
        if SKIP.search(line):
            continue
        context = []
        while stripped[k - len(context):k + 1] and sum(
                stripped[j:j + len(context) + 1] == stripped[k - len(context):k + 1] for j in range(len(lines))) > 1 and len(context) < 3:
            context.insert(0, stripped[k - len(context) - 1])
        comment = line[len(line.split("//")[0]):]
        for what, changed in line_changes(line):
            new = f"{changed.rstrip()}  {comment}".rstrip() if comment and not changed.startswith("//") else changed
            yield entries.written(name, f"? {what}", context, [line], [new])


def suggest(folder, per_file, seed):
    """Prints up to `per_file` proposals of each file of src/<folder>, chosen by chance, in the order of the file."""
    chance = random.Random(seed)
    for path in sorted((entries.ROOT / "src" / folder).glob("*.[ch]pp")):
        found = list(proposals(path, path.relative_to(entries.ROOT).as_posix()))
        for k in sorted(chance.sample(range(len(found)), min(per_file, len(found)))) if per_file else range(len(found)):
            print(found[k] + "\n")
