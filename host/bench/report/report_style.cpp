#include "bench/report/report_style.hpp"

namespace clarity::bench {

// Colours: Okabe and Ito 2008. The track of a bar leaves 4.5em on its right for the number beside a full bar.
const char* const kReportStyle = R"css(
:root { color-scheme: light dark; --paper: #fff; --ink: #1d2126; --faint: #626a73; --rule: #d9dde2; --panel: #f5f6f8; --ref: #b3261e;
  --c0: #0072b2; --c1: #e69f00; --c2: #009e73; --c3: #d55e00; --c4: #cc79a7; --c5: #56b4e9; --c6: #7a7f87; }
@media (prefers-color-scheme: dark) { :root { --paper: #14171b; --ink: #e4e7eb; --faint: #9aa3ad; --rule: #363c44; --panel: #1c2026;
  --ref: #ff8a80; --c0: #4aa3df; --c1: #e69f00; --c2: #2bb98f; --c3: #f0803c; --c4: #d993b8; --c5: #8fcdf2; --c6: #949aa3; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.2rem 1rem 4rem; max-width: 76rem; background: var(--paper); color: var(--ink);
  font: 16px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.8rem; line-height: 1.2; margin: .4rem 0; } h2 { margin: 2.6rem 0 .4rem; border-top: 1px solid var(--rule); padding-top: 1.2rem; }
h3 { margin: 1.6rem 0 .3rem; } p { max-width: 46rem; margin: .4rem 0 .8rem; } small, .faint { color: var(--faint); font-weight: normal; }
nav { margin: .8rem 0; } nav a { margin-right: 1rem; } a { color: var(--c0); }
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 25rem), 1fr)); gap: 1rem; }
.three { grid-template-columns: repeat(auto-fill, minmax(min(100%, 20rem), 1fr)); }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(11rem, 1fr)); gap: .8rem; margin: 1rem 0; }
.tiles div { background: var(--panel); border-radius: .5rem; padding: .7rem .9rem; } .tiles b { display: block; font-size: 1.5rem; line-height: 1.2; }
.tiles span { font-size: .85rem; color: var(--faint); }
figure { margin: 0; background: var(--panel); border-radius: .5rem; padding: .8rem .9rem; break-inside: avoid; }
figcaption { font-weight: 600; line-height: 1.35; margin-bottom: .4rem; }
.bars { font-size: .86rem; } .bars .row { display: grid; grid-template-columns: min(var(--label), 45%) 1fr; min-height: 1.5em; }
.bars .head { margin-top: 0; } .bars .head b { white-space: nowrap; font-weight: 600; padding-top: .25em; }
.bars .label { white-space: nowrap; overflow: hidden; text-overflow: ellipsis; padding-right: .5em; color: var(--faint); }
.bars .track { position: relative; display: block; margin-right: 4.5em; border-left: 1px solid var(--rule); }
.bars .bar { position: absolute; left: 0; top: .22em; height: 1.1em; border-radius: 0 2px 2px 0; }
.bars .value { position: absolute; top: 0; padding: 0 .25em; margin-left: .1em; white-space: nowrap; background: var(--panel);
  font-variant-numeric: tabular-nums; line-height: 1.5em; }
.bars .ref { position: absolute; top: 0; bottom: 0; border-left: 2px dashed var(--ref); }
.key { display: inline-block; width: 0; height: 1em; border-left: 2px dashed var(--ref); vertical-align: -.15em; margin-right: .3em; }
.bars .axis .track { border-left-color: transparent; min-height: 1.4em; } .bars .axis .track span { position: absolute; transform: translateX(-50%);
  color: var(--faint); font-size: .85em; white-space: nowrap; }
.c0 { background: var(--c0); } .c1 { background: var(--c1); } .c2 { background: var(--c2); } .c3 { background: var(--c3); }
.c4 { background: var(--c4); } .c5 { background: var(--c5); } .c6 { background: var(--c6); }
.wide { overflow-x: auto; } svg { display: block; width: 100%; min-width: 34rem; height: auto; font-size: 12px; } svg text { fill: var(--ink); }
svg .grid { display: inline; } svg .grid path { stroke: var(--rule); } svg .grid text { fill: var(--faint); } svg .line { fill: none; stroke-width: 2; } svg .lead { fill: none; stroke-width: .6; opacity: .6; }
.k0 { fill: var(--c0); stroke: var(--c0); } .k1 { fill: var(--c1); stroke: var(--c1); } .k2 { fill: var(--c2); stroke: var(--c2); }
.k3 { fill: var(--c3); stroke: var(--c3); } .k4 { fill: var(--c4); stroke: var(--c4); } .k5 { fill: var(--c5); stroke: var(--c5); }
.k6 { fill: var(--c6); stroke: var(--c6); }
table { border-collapse: collapse; font-size: .86rem; font-variant-numeric: tabular-nums; margin: .6rem 0; }
th, td { padding: .22rem .6rem .22rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--rule); }
th { color: var(--faint); font-weight: 600; white-space: nowrap; } .n { text-align: right; white-space: nowrap; }
details { margin: .6rem 0; } summary { cursor: pointer; font-weight: 600; } .warn { border-left: 3px solid var(--ref); padding-left: .7rem; }
@media print { body { max-width: none; font-size: 10pt; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } nav { display: none; } }
)css";

}  // namespace clarity::bench
