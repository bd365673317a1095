"""The style sheet of the HTML report."""

STYLE = """
:root { color-scheme: light dark; --ink: #1a1a1a; --paper: #ffffff; --line: #d0d0d0; --soft: #f4f4f4;
  --good: #00694a; --bad: #b3261e; --link: #00558b;
  --reference: #999999; --bem: #0072b2; --fem: #d55e00; --closed: #009e73; --grid: #d9d9d9; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --paper: #16181b; --line: #3b3f45;
  --soft: #1f2226; --good: #4fd1a5; --bad: #ff8a80; --link: #79b8ff;
  --reference: #8a8a8a; --bem: #56b4e9; --fem: #e69f00; --closed: #2fc79a; --grid: #34383e; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 76rem; background: var(--paper); color: var(--ink);
  font: 16px/1.5 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; line-height: 1.2; } h2 { font-size: 1.2rem; line-height: 1.3; margin-top: 2.5rem; }
h3 { font-size: 1rem; margin-bottom: 0.3rem; }
a { color: var(--link); }
p { max-width: 46rem; }
.pass { color: var(--good); font-weight: 600; } .fail { color: var(--bad); font-weight: 700; }
.wide { overflow-x: auto; } span.whole { white-space: nowrap; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: 0.2rem 0.7rem 0.2rem 0;
  border-bottom: 1px solid var(--line); }
td:nth-last-child(1) { min-width: 12rem; }
th { white-space: nowrap; }
.figures { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); }
figure { margin: 0; min-width: 0; }
figure svg { display: block; width: 100%; height: auto; max-width: 34rem; color: var(--ink); }
figure img { display: block; width: 100%; height: auto; max-width: 64rem; background: #fff; }
.wide img { min-width: 42rem; }
figure.whole { grid-column: 1 / -1; } figure.whole svg { max-width: 64rem; }
figcaption { font-size: 0.85rem; }
details { margin: 0.5rem 0; } summary { cursor: pointer; }
@media print { :root { --ink: #000; --paper: #fff; --line: #999; --reference: #999999; --bem: #0072b2;
    --fem: #d55e00; --closed: #009e73; --grid: #d9d9d9; --good: #00694a; --bad: #b3261e; }
  body { max-width: none; font-size: 10pt; } figure, tr { break-inside: avoid; }
  section[id^="scene-"] { break-before: page; }
  .wide { overflow: visible; } .figures { grid-template-columns: 1fr 1fr; } }
"""
