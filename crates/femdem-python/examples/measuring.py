"""Packs are measured, and compared over their friction: docs/tutorials/measuring.md, smaller."""

import femdem

for friction in (0.2, 0.6):
    pack = femdem.pack(count=20, box="3x3", friction=friction, seed=1)
    measured = femdem.analyse(pack)
    print(f"friction {friction}: coordination {pack.summary['coordination']['mean']:.2f}")
    assert measured.analysis and (pack.folder / "analysis").is_dir()

page = femdem.report(pack).report()
print("a page for the browser of", len(page), "characters")
