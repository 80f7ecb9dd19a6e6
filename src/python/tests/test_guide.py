"""The page of the guide: its programs run, and print what it says."""

import contextlib
import io
import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "guide" / "python.md"
BLOCK = re.compile(r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?", re.DOTALL)


def test_programs_of_the_page_print_what_it_says(tmp_path):
    names = {"__file__": str(tmp_path / "page.py"), "__name__": "page"}
    blocks = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert len(blocks) >= 5
    for code, said in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, names["__file__"], "exec"), names)
        if said:
            assert printed.getvalue() == said
