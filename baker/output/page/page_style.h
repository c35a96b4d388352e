// How a page looks: one style sheet for light and dark, paper and telephone. No fonts and no pictures from elsewhere.
#pragma once

namespace pliant {

inline constexpr const char* page_style = R"css(
:root { color-scheme: light dark; --paper: #faf8f5; --card: #f1eee8; --ink: #26231f; --soft: #6b655c; --rule: #dfdad1;
  --accent: #3d6785; --warm: #b0552f; --good: #4a7352;
  --pose-0: #7d8fa3; --pose-1: #c08a5b; --pose-2: #6f9a82; --pose-3: #a8728c; --pose-4: #b9a44c; --pose-5: #6686b8;
  --pose-6: #98795f; --pose-7: #58a0a6; }
@media (prefers-color-scheme: dark) { :root { --paper: #191816; --card: #24221f; --ink: #e8e3da; --soft: #a39c90;
  --rule: #3a3733; --accent: #86b0cd; --warm: #e08a5e; --good: #8dbb95; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Source Sans 3", "Segoe UI", system-ui, -apple-system, "Helvetica Neue", Arial, sans-serif;
  overflow-wrap: anywhere; }
main { max-width: 66rem; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font: 600 2.1rem/1.15 Charter, "Iowan Old Style", "Palatino Linotype", Georgia, serif; margin: 0 0 .5rem; }
h2 { font: 600 1.35rem/1.25 Charter, "Iowan Old Style", "Palatino Linotype", Georgia, serif; margin: 3rem 0 .35rem;
  padding-top: 1.1rem; border-top: 1px solid var(--rule); }
h3 { font-size: 1rem; font-weight: 600; margin: 1.6rem 0 .5rem; }
p { margin: .35rem 0 .9rem; max-width: 42rem; }
.verdict { font-size: 1.12rem; }
.verdict b { font-weight: 600; }
.kept { color: var(--good); } .missed { color: var(--warm); }
.kind, .note, figcaption .note { color: var(--soft); font-size: .875rem; }
.kind { text-transform: uppercase; letter-spacing: .08em; font-size: .75rem; margin: 0 0 .4rem; }
.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(8.5rem, 1fr)); gap: .1rem 1.5rem;
  margin: 1.6rem 0 0; }
.facts div { border-top: 1px solid var(--rule); padding: .5rem 0 .7rem; }
.facts dt { color: var(--soft); font-size: .8rem; }
.facts dd { margin: 0; font-size: 1.2rem; font-variant-numeric: tabular-nums; }
.number, td.number, .facts dd { font-variant-numeric: tabular-nums; }
.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 11.5rem), 1fr)); gap: 1rem; }
.pairs { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 29rem), 1fr)); gap: 1.4rem 1.6rem; }
.pair, .trio { display: grid; gap: .75rem; grid-template-columns: 1fr 1fr; }
.trio { grid-template-columns: repeat(3, 1fr); }
figure { margin: 0; break-inside: avoid; }
.picture { position: relative; background: var(--card); border-radius: 6px; padding: 4% 0; display: flex;
  justify-content: center; }
.picture > div { position: relative; line-height: 0; }
.picture img { display: block; max-width: 100%; height: auto; filter: sepia(.42) saturate(1.15); }
.linear .picture img { filter: sepia(.32) hue-rotate(165deg); }
.coloured .picture img { filter: none; }
.picture svg { position: absolute; inset: 0; width: 100%; height: 100%; overflow: visible; }
.picture circle { fill: none; stroke: var(--accent); stroke-width: 2.5; } .picture circle.hidden { stroke-dasharray: 3 3; }
figcaption { font-size: .9rem; line-height: 1.35; padding-top: .45rem; } figcaption .note { display: block; }
.scale { display: inline-block; width: 7rem; height: .6rem; border-radius: 3px; vertical-align: baseline; margin: 0 .4rem;
  background: linear-gradient(90deg, #bdbdbd, #ecc36a 45%, #c2431b); }
.chart { max-width: 36rem; margin: .8rem 0; }
.chart svg { display: block; width: 100%; height: auto; }
.chart text { fill: var(--soft); font: 12px system-ui, "Helvetica Neue", Arial, sans-serif;
  font-variant-numeric: tabular-nums; }
.grid { stroke: var(--rule); stroke-width: 1; } .axis { stroke: var(--soft); stroke-width: 1; }
.limit { stroke: var(--good); stroke-width: 1.5; stroke-dasharray: 6 4; }
.curve { fill: none; stroke: var(--accent); stroke-width: 1.5; opacity: .55; }
circle.check { fill: var(--accent); } circle.fresh { fill: var(--paper); stroke: var(--accent); stroke-width: 2; }
circle.worst { fill: var(--warm); stroke: var(--warm); }
.blob { fill: var(--accent); stroke: var(--accent); } .fresh-blob { stroke-dasharray: 2 2; }
.amplitude { fill: var(--accent); } .bits { fill: var(--soft); opacity: .6; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: .2rem 1.1rem; padding: 0; margin: .6rem 0;
  font-size: .9rem; }
.legend i { display: inline-block; width: .8rem; height: .8rem; border-radius: 2px; margin-right: .4rem;
  vertical-align: -1px; }
.checks { max-width: 46rem; margin: .8rem 0; }
.check-row { display: grid; grid-template-columns: minmax(5rem, 11rem) 1fr 4.8rem; gap: .8rem; align-items: center;
  padding: 2px 0; font-size: .875rem; break-inside: avoid; }
.check-row.head { color: var(--soft); font-size: .8rem; } .check-row .number { text-align: right; }
.strip { display: flex; height: .7rem; border-radius: 2px; overflow: hidden; background: var(--card); }
.strip i { display: block; }
.bar { position: relative; display: block; height: .7rem; background: var(--card); border-radius: 2px; }
.bar i { position: absolute; inset: 0 auto 0 0; border-radius: 2px; background: var(--accent); }
.bar i.is-fresh { background: transparent; border: 2px solid var(--accent); }
.bar b { position: absolute; top: -2px; bottom: -2px; border-left: 2px dashed var(--good); }
table { border-collapse: collapse; width: 100%; max-width: 46rem; margin: .8rem 0 1rem; font-size: .9375rem; }
caption { text-align: left; font-weight: 600; padding: .6rem 0 .3rem; }
th { text-align: left; font-weight: 400; color: var(--soft); font-size: .8rem; border-bottom: 1px solid var(--rule); }
th, td { padding: .32rem .6rem .32rem 0; vertical-align: top; } td { border-bottom: 1px solid var(--rule); }
th.number, td.number { text-align: right; padding-right: 0; padding-left: .6rem; white-space: nowrap; }
.bars .name { font-weight: 600; margin-right: .6rem; } .bars .what { color: var(--soft); }
.mixtures th.number { white-space: normal; } .mixtures td { white-space: nowrap; }
.bar-cell { width: 30%; padding-top: .68rem; }
.groups { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 22rem), 1fr)); gap: 0 2.5rem; }
.groups dl { display: grid; grid-template-columns: 1fr auto; margin: 0; font-size: .9rem; }
.groups dt, .groups dd { border-top: 1px solid var(--rule); padding: .28rem 0; margin: 0; }
.groups dt { color: var(--soft); }
.groups dd { text-align: right; padding-left: 1rem; font-variant-numeric: tabular-nums; max-width: 14rem; }
.warning { border-left: 3px solid var(--warm); padding: .1rem 0 .1rem 1rem; margin: 1.2rem 0; display: flex; flex-wrap: wrap;
  gap: .8rem 1.5rem; break-inside: avoid; }
.warning > div { flex: 1 1 20rem; min-width: 0; } .warning > figure { flex: 0 1 17rem; }
.warning p { margin: .2rem 0 .4rem; }
.code { color: var(--warm); font-weight: 600; font-variant-numeric: tabular-nums; }
details { margin: 1.4rem 0; } summary { cursor: pointer; color: var(--accent); }
pre { font: .78rem/1.45 ui-monospace, "Cascadia Mono", Menlo, Consolas, monospace; background: var(--card); padding: 1rem;
  border-radius: 6px; white-space: pre-wrap; }
footer { color: var(--soft); font-size: .85rem; margin-top: 3rem; border-top: 1px solid var(--rule); padding-top: .8rem; }
@media (max-width: 34rem) { main { padding: 1.4rem 1rem 3rem; } h1 { font-size: 1.6rem; }
  .gallery { grid-template-columns: 1fr 1fr; } .check-row { grid-template-columns: 7rem 1fr 4.2rem; }
  .trio { grid-template-columns: 1fr 1fr; } .trio figure:last-child { grid-column: 1 / -1; } .bar-cell { display: none; }
  .bars th:nth-child(2), .mixtures :is(th, td):is(:nth-child(2), :nth-child(n + 6)) { display: none; }
  .bars .what { display: block; } .facts { grid-template-columns: 1fr 1fr; } }
@media print { :root { --paper: #fff; --card: #f4f2ee; --ink: #111; --soft: #555; --rule: #ccc; --accent: #3d6785;
  --warm: #b0552f; --good: #4a7352; color-scheme: light; }
  .pairs { grid-template-columns: 1fr 1fr; }
  body { font-size: 10.5pt; } main { max-width: none; padding: 0; } h2 { break-after: avoid; } details { display: none; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)css";

} // namespace pliant
