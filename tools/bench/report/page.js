// page.js -- draws the report from the records that the page holds (report.cpp says what `data` is). Bars are boxes, so that
// their text can be searched and keeps its size; every bar shows its number. Curves are drawn by Chart.js.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const records = data.records;

// ---- text, numbers, elements

// Control characters in names are shown as U+FFFD.
const clean = text => String(text).replace(/[\0-\x08\x0b-\x1f\x7f-\x9f\ufffe\uffff]/g, '\ufffd');

// An element. `attributes` may hold class, title, id and others; children are elements or texts. Falsy children are left out.
function el(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) element.setAttribute(name, clean(value));
    element.append(...children.flat().filter(c => c || c === 0).map(c => c instanceof Node ? c : clean(c)));
    return element;
}

// Three significant digits, with thin spaces between thousands; '' for what is no number.
function figure(value) {
    if (typeof value !== 'number' || !isFinite(value)) return '';
    if (value === 0) return '0';
    const text = Math.abs(value) >= 100 ?
        value.toFixed(0) :
        Number(value.toPrecision(3)).toFixed(Math.max(0, 2 - Math.floor(Math.log10(Math.abs(value)))));
    const [whole, part] = text.split('.');
    const spaced = whole.replace('-', '').length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, '\u202f') : whole;
    return part ? spaced + '.' + part : spaced;
}
// The same without zeros at its end, for axes.
const tick = value => figure(value).replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, '');
const figureOrNothing = value => value > 0 ? figure(value) : '';
const percent = share => figure(100 * share) + '\u00a0%';
const plural = (n, word) => n + ' ' + word + (n === 1 ? '' : 's');

// A table. The first `left` columns are text. Empty columns are left out; a table without rows is nothing.
function table(head, left, rows) {
    if (!rows.length) return null;
    const used = head.map((_, c) => rows.some(row => row[c]));
    const line = (row, tag) => el('tr', {}, head.map((_, c) => used[c] && el(tag, c < left ? {} : {class: 'n'}, row[c])));
    return el(
        'div', {class: 'wide'},
        el('table', {}, el('thead', {}, line(head, 'th')), el('tbody', {}, rows.map(r => line(r, 'td')))));
}

// Groups of records with the same key, in the order of their first records.
function groups(rows, key) {
    const found = new Map();
    for (const r of rows) found.set(key(r), [...(found.get(key(r)) || []), r]);
    return [...found.values()];
}

// ---- records

const name = r => r.peer || r.variant;
const isOk = r => r.status === 'ok';
const hasFigures = r => isOk(r) && (r.time_ms || r.wall_ms);
const times = (r, key) => (r[key] || {});
const rays = r => r.rays ? r.rays.primary + r.rays.shadow + r.rays.secondary : 0;
const spread = r => Math.max(times(r, 'time_ms').spread || 0, times(r, 'wall_ms').spread || 0);
const repeats = r => Math.max(times(r, 'time_ms').n || 0, times(r, 'wall_ms').n || 0);
const isBuild = r => r.measure === 'build';
// Frames a second of pictures, million triangles a second of builds, million rays a second of rays.
const speed = r => (r.measure === 'frame' ? r.fps : isBuild(r) ? r.mtris_per_s : r.mrays_per_s) || 0;

// Our speed by theirs. Within the root of the sum of both squared spreads, neither is called faster.
function ratio(ours, theirs) {
    if (!(speed(theirs) > 0) || !(speed(ours) > 0)) return '';
    const clock = r => times(r, r.measure === 'frame' ? 'wall_ms' : 'time_ms').spread || 0;
    const by = speed(ours) / speed(theirs);
    return Math.max(by, 1 / by) <= 1 + Math.hypot(clock(ours), clock(theirs)) ? 'about the same' : figure(by);
}

// ---- names and colours of series, the same in all charts

const kGrey = 6;  // for baselines

function shortDevice(r) {
    if (r.peer || /^(pthread|cpu)|CPU|Xeon|EPYC|Ryzen/.test(r.device)) return 'CPU';
    const text = ['NVIDIA ', 'AMD ', 'Intel(R) ', 'GeForce '].reduce(
        (t, maker) => t.startsWith(maker) ? t.slice(maker.length) : t, r.device);
    const end = text.indexOf(' ', 4);
    return (end < 0 ? text : text.slice(0, end)).slice(0, 20) || 'device';
}

// Baselines and builds run on the host's processor, which the report calls CPU; they add no device.
const devices = new Map();
for (const r of records) {
    if (r.peer || !r.device || isBuild(r) || devices.has(r.device)) continue;
    const short = shortDevice(r), taken = [...devices.values()];
    let unique = short;
    for (let n = 2; taken.includes(unique); ++n) unique = short + ' ' + n;
    devices.set(r.device, unique);
}
const several = devices.size > 1;
const device = r => devices.get(r.device) || shortDevice(r);
const onDevice = r => several ? ', ' + device(r) : '';
const label = r => r.peer || isBuild(r) ? name(r) : name(r) + onDevice(r);

const colors = new Map();
// Rows of packets and array sizes have charts of their own, in which positions tell them apart instead of colours.
for (const r of records) {
    if (r.peer || isBuild(r) || r.measure === 'dropped' || r.suite === 'packets' || colors.has(label(r))) continue;
    const color = new Set(colors.values()).size % kGrey;
    colors.set(label(r), color);
    if (!colors.has(r.variant)) colors.set(r.variant, color);  // for its builds, on any device
}
const color = r => r.peer || !colors.has(label(r)) ? kGrey : colors.get(label(r));

// ---- charts

function hint(r) {
    if (!isOk(r)) return r.why || '';
    return name(r) + ': kernels p50 ' + figure(times(r, 'time_ms').p50) + ' ms, all in p50 ' + figure(times(r, 'wall_ms').p50) +
        ' ms, spread ' + percent(spread(r)) + ' of ' + plural(repeats(r), 'repetition') +
        (rays(r) ? ', ' + figure(rays(r)) + ' rays' : '') +
        (r.lanes ? ', packet ' + r.packet + ', ' + plural(r.lanes, 'lane') : '');
}

// A bar of a record: its value, or the word that says why it has none.
const bar = (r, value, more) =>
    ({label: label(r), color: color(r), hint: hint(r), value: isOk(r) ? value : 0, text: isOk(r) ? '' : r.status, ...more});

// chart: {title, unit, groups: [{title, bars}], reference, referenceText, whole}. The axis is logarithmic if the largest value
// is more than 30 times the smallest; it reaches at least to `whole`.
function barChart(chart) {
    const bars = chart.groups.flatMap(g => g.bars);
    if (!bars.length) return null;
    const values = [...bars.map(b => b.value), chart.reference].filter(v => v > 0 && isFinite(v));
    const least = Math.min(...values), most = Math.max(...values, chart.whole || 0);
    const log = values.length && !chart.whole && most / least > 30;
    const low = log ? 10 ** Math.floor(Math.log10(least * .999)) : 0;
    const share = v => !(v > 0) || !isFinite(v) || !values.length ? 0 :
        log                                                       ? Math.log(v / low) / Math.log(most / low) :
                                                                    v / most;
    const at = v => (100 * Math.min(1, share(v))).toFixed(2) + '%';
    const ticks = [];  // at most six
    if (log) {
        const decades = Math.log10(most / low);
        for (let d = 0; d <= decades; d += Math.ceil(decades / 5)) ticks.push(low * 10 ** d);
    } else if (values.length) {
        const rough = most / 4, scale = 10 ** Math.floor(Math.log10(rough)),
              step = scale * [1, 2, 5, 10].find(s => rough / scale <= s);
        for (let v = 0; v <= most; v += step) ticks.push(v);
    }
    const track = (hint, ...parts) =>
        el('span', {class: 'track', title: hint},
           chart.reference > 0 && el('i', {class: 'ref', style: 'left:' + at(chart.reference)}), parts);
    const width = Math.min(14, Math.max(4.5, .56 * Math.max(...bars.map(b => b.label.length)) + 1));
    return el(
        'figure', {class: 'bars', style: '--label:' + width + 'em'},
        el('figcaption', {}, chart.title, ' ', el('small', {}, chart.unit + (log ? ', logarithmic' : '')),
           chart.reference > 0 && [el('br'), el('small', {}, el('i', {class: 'key'}), chart.referenceText)]),
        chart.groups
            .map(
                group =>
                    [group.title && el('div', {class: 'row'}, el('span', {class: 'head'}, group.title), track('')),
                     group.bars.map(
                         b => el(
                             'div', {class: 'row'}, el('span', {class: 'label', title: b.label}, b.label),
                             track(
                                 b.hint,
                                 b.value > 0 &&
                                     el('i',
                                        {class: 'bar', style: 'width:' + at(b.value) + ';background:var(--c' + b.color + ')'}),
                                 el('span', {class: 'value', style: 'left:' + at(b.value)}, b.text || figure(b.value)))))])
            .flat(2),
        el('div', {class: 'row axis'}, el('span'),
           el('span', {class: 'track'}, ticks.map(t => el('span', {style: 'left:' + at(t)}, tick(t))))));
}

// Curves can be told apart without colour: each series has a marker, the same in all charts.
const markers = new Map();
function marker(series) {
    if (!markers.has(series)) markers.set(series, ['circle', 'rect', 'triangle', 'rectRot'][markers.size % 4]);
    return markers.get(series);
}

// curves: [{label, color, points: [{x, y}]}]; both axes are logarithmic. Nothing if no curve has two points.
function curveChart(title, unit, xUnit, curves) {
    if (!curves.some(c => c.points.length > 1)) return null;
    const canvas = el('canvas', {
        role: 'img',
        'aria-label': title + ', ' + unit + ' over ' + xUnit + ': ' +
            curves.map(c => c.label + ' ' + c.points.map(p => figure(p.y) + ' at ' + figure(p.x)).join(', ')).join('; ')
    });
    const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis = text => ({
        type: 'logarithmic',
        title: {display: true, text, color: css('--faint')},
        grid: {color: css('--rule')},
        ticks: {color: css('--faint'), callback: v => Math.abs(Math.log10(v) % 1) < 1e-9 ? tick(v) : ''}
    });
    new Chart(canvas, {
        type: 'line',
        data: {
            datasets: curves.map(c => ({
                                     label: c.label + '  ' + figure(c.points[c.points.length - 1].y),
                                     data: c.points,
                                     borderColor: css('--c' + c.color),
                                     backgroundColor: css('--c' + c.color),
                                     pointStyle: marker(c.label),
                                     pointRadius: 4,
                                     borderWidth: 2
                                 }))
        },
        options: {
            animation: false,
            maintainAspectRatio: false,
            scales: {x: axis(xUnit), y: axis(unit)},
            plugins: {
                legend: {position: 'bottom', align: 'start', labels: {color: css('--ink'), usePointStyle: true, boxHeight: 6}},
                tooltip: {
                    callbacks: {
                        title: () => '',
                        label: p => curves[p.datasetIndex].label + ': ' + figure(p.parsed.y) + ' at ' + figure(p.parsed.x)
                    }
                }
            }
        }
    });
    return el(
        'figure', {}, el('figcaption', {}, title, ' ', el('small', {}, unit + '; both axes logarithmic')),
        el('div', {class: 'curve'}, canvas));
}

const grid = (charts, more = '') => charts.some(c => c) && el('div', {class: 'grid' + more}, charts);

// ---- sections: each returns its content, or nothing if nothing of its kind was measured

// The thesis's tests, and the figure to compare with. Of the six tests that is the end of the chart's axis, which no device of
// 2008 reached.
const axisEnd = fps => 'the thesis\u2019s chart ends at ' + fps + ' fps';
const kTests = {
    '1_two_triangles': {title: 'Test 1: 2 triangles', fps: 40, numbered: true},
    '2_two_spheres': {title: 'Test 2: 2 spheres', fps: 100, numbered: true},
    '3_triangle_two_spheres': {title: 'Test 3: 1 triangle and 2 spheres', fps: 35, numbered: true},
    '4_35_triangles': {title: 'Test 4: 35 triangles', fps: 14, numbered: true},
    '5_36_spheres': {title: 'Test 5: 36 spheres', fps: 7, numbered: true},
    '6_2406_triangles': {title: 'Test 6: 2406 triangles', fps: .3, numbered: true},
    spheres21:
        {title: 'The demo that it cites: 21 spheres on a plane', fps: 70, meaning: '70 fps, GeForce 8800 GTS, about 800x600'},
    aim_100k: {title: 'Its aim: a hundred thousand polygons', fps: 60, meaning: '60 fps at 1024x768, not reached in 2008'}
};
const meaning = test => test.meaning || axisEnd(test.fps);

function thesisTiles(rows) {
    const ranges = new Map(), tiles = [];
    const tile = (big, small) => el('div', {}, el('b', {}, big), el('span', {}, small));
    for (const row of rows) {
        const r = row[row.length - 1], test = kTests[r.scene];
        if (!test || !hasFigures(r) || r.variant === 'then' || r.depth !== 4) continue;
        if (!test.numbered) {
            tiles.push(tile(figure(r.fps) + ' fps', device(r) + ': ' + test.title + ' (' + meaning(test) + ')'));
            continue;
        }
        const gain = r.fps / test.fps, range = ranges.get(device(r)) || {least: Infinity, most: 0, tests: 0};
        if (gain < range.least) Object.assign(range, {least: gain, test: test.title});
        ranges.set(device(r), Object.assign(range, {most: Math.max(range.most, gain), tests: range.tests + 1}));
    }
    const gains = [...ranges].map(
        ([device, g]) => tile(
            figure(g.least) + ' to ' + figure(g.most) + ' x',
            device + ': the ends of the thesis\u2019s axes, at 4 steps, ' + plural(g.tests, 'test') + '; least in ' + g.test));
    return (gains.length || tiles.length) && el('div', {class: 'tiles'}, gains, tiles);
}

function thesisSection() {
    const frames = records.filter(r => (r.suite === 'thesis' || r.suite === 'quick') && r.measure === 'frame');
    if (!frames.length) return null;
    const rows = groups(frames, r => [r.suite, r.scene, r.device, r.variant].join('\n'));
    const charts = groups(frames, r => r.suite + '\n' + r.scene).map(scene => {
        const test = kTests[scene[0].scene];
        const steps = groups([...scene].sort((a, b) => a.depth - b.depth), r => r.depth);
        return barChart({
            title: test ? test.title : scene[0].scene,
            unit: 'frames per second',
            reference: test && test.fps,
            referenceText: test && meaning(test),
            groups: steps.map(rows => ({title: plural(rows[0].depth, 'step'), bars: rows.map(r => bar(r, r.fps))}))
        });
    });
    const then = new Map(
        frames.filter(r => r.variant === 'then' && hasFigures(r)).map(r => [[r.scene, r.device, r.depth].join('\n'), r]));
    const lines = rows.map(row => {
                          const shown = row.filter(r => hasFigures(r) && r.depth >= 1 && r.depth <= 4);
                          if (!shown.length) return null;
                          const last = shown.reduce((a, b) => b.depth > a.depth ? b : a), test = kTests[last.scene];
                          const naive = last.variant !== 'then' && then.get([last.scene, last.device, last.depth].join('\n'));
                          const fps = [1, 2, 3, 4].map(depth => figure((shown.filter(r => r.depth === depth).pop() || {}).fps));
                          return [
                              test ? test.title : last.scene, label(last), ...fps, figure(times(last, 'time_ms').p50),
                              figure(times(last, 'wall_ms').p50), figureOrNothing(times(last, 'wall_ms').p95),
                              figureOrNothing(times(last, 'wall_ms').p99), percent(spread(last)), figure(last.mrays_per_s),
                              test ? figure(last.fps / test.fps) : '', naive ? ratio(last, naive) : ''
                          ];
                      })
                      .filter(line => line);
    const kernels = frames.filter(r => r.scene === 'aim_100k' && hasFigures(r) && r.kernels_ms).flatMap(r => {
        const sum = Object.values(r.kernels_ms).reduce((a, b) => a + b, 0);
        return Object.entries(r.kernels_ms)
            .map(([kernel, ms]) => [r.scene, label(r), kernel, figure(ms), sum > 0 ? percent(ms / sum) : '']);
    });
    return [
        thesisTiles(rows),
        el('p', {},
           'Frames per second by generations of rays (the thesis\u2019s steps), as the thesis draws them. The dashed line is the end of the axis ' +
               'of its chart, which is above all that its two graphics cards and two processors reached in 2008. \u201cthen\u201d is its design on this machine: trees of bounding ' +
               'spheres split by count, one per mesh without a top level, one ray at a time in packets of 4x4. \u201cnow\u201d is this program with its default settings. Both time ' +
               'a frame from the call until its pixels are in host memory.'),
        grid(charts),
        table(
            [
                'test', 'design', '1 step', '2 steps', '3 steps', '4 steps', 'kernels p50, ms', 'all in p50, ms', 'p95', 'p99',
                'spread', 'Mrays/s', 'x thesis\u2019s axis', 'x then'
            ],
            2, lines),
        kernels.length &&
            [
                el('h3', {}, 'Where a frame of the aim spends its time'),
                table(['scene', 'design', 'kernel', 'ms', 'share'], 3, kernels)
            ]
    ];
}

function packetsSection() {
    const charts =
        groups(records.filter(r => r.suite === 'packets'), r => r.scene + '\n' + r.device)
            .map(scene => barChart({
                     title: scene[0].scene + onDevice(scene[0]),
                     unit: 'frames per second, 4 steps',
                     groups: groups([...scene].sort((a, b) => a.lanes - b.lanes), r => r.lanes)
                                 .map((rows, i) => ({
                                          title: plural(rows[0].lanes || 0, 'lane'),
                                          bars: rows.map(r => bar(r, r.fps, {label: 'packet ' + r.packet, color: i % 7}))
                                      }))
                 }));
    return charts.length && [
        el('p', {},
           'Packet: the pixels which one work-item computes. Lanes: the rays which it traces side by side. The thesis found 4x4 best on its graphics ' +
               'cards, where every ray of a packet was traced on its own. Here a packet of 4x4 on 16 lanes is traversed like one ray: a node is fetched once for all. A structure that ' +
               'takes streams traces all such groups of a larger packet together, up to as many groups as lanes.'),
        grid(charts)
    ];
}

const kRays = {
    primary: 'Camera rays',
    shadow: 'Shadow rays',
    reflection: 'Mirrored rays',
    diffuse: 'Diffusely scattered rays'
};
const kMeasures = [
    ...Object.entries(kRays).map(([key, title]) => [key, title, 'million rays a second']),
    ['frame', 'Whole frames', 'frames per second'], ['build', 'Building', 'million triangles a second']
];

function structuresSection() {
    const scenes = groups(
        records.filter(r => r.suite === 'accel' || (r.suite === 'quick' && r.measure !== 'frame')),
        r => r.suite + '\n' + r.scene);
    if (!scenes.length) return null;
    const best = rows => rows.reduce((a, b) => !a || speed(b) > speed(a) ? b : a, null);
    const against = scenes
                        .flatMap(scene => Object.entries(kRays).map(([key, title]) => {
                            const rows = scene.filter(r => r.measure === key && hasFigures(r)),
                                  ours = best(rows.filter(r => !r.peer)), theirs = best(rows.filter(r => r.peer));
                            return ours && theirs && [
                                ours.scene, title, label(ours), name(theirs), figure(speed(ours)), figure(speed(theirs)),
                                ratio(ours, theirs)
                            ];
                        }))
                        .filter(line => line);
    const keys = ['mtris_per_s', 'bytes_per_triangle', 'nodes', 'sah_cost'];
    return [
        el('p', {},
           'All structures trace the same rays, which are made once on the host: camera rays, and from each hit a ray to the light, a mirrored ray and a diffusely ' +
               'scattered ray. Peers (grey) trace the same rays with the same number of threads, and are measured interleaved with ours. Only active rays count: a pixel whose camera ' +
               'ray hit nothing has no secondary rays.'),
        table(['scene', 'rays', 'best of ours', 'best peer', 'ours, Mrays/s', 'theirs', 'ours by theirs'], 4, against),
        scenes.map(
            (scene, i) => el(
                'details', i === 0 ? {open: ''} : {},
                el('summary', {},
                   scene[0].scene + ', ' + (scene[0].triangles < 1000 ? scene[0].triangles : figure(scene[0].triangles)) +
                       ' triangles'),
                grid(kMeasures.map(
                    ([key, title, unit]) => barChart(
                        {title, unit, groups: [{bars: scene.filter(r => r.measure === key).map(r => bar(r, speed(r)))}]}))),
                table(
                    ['structure', 'build p50, ms', ...keys.map(key => data.looks.record[key])], 1,
                    scene.filter(r => isBuild(r) && hasFigures(r))
                        .map(r => ([name(r), figure(times(r, 'time_ms').p50), ...keys.map(key => figureOrNothing(r[key]))])))))
    ];
}

function scaleSection() {
    const charts = kMeasures.map(([key, title, unit]) => {
        const rows =
            records.filter(r => r.suite === 'scale' && r.measure === key && hasFigures(r) && r.triangles > 0 && speed(r) > 0);
        return curveChart(
            title, unit, 'triangles',
            groups(rows, label).map(curve => ({
                                        label: label(curve[0]),
                                        color: color(curve[0]),
                                        points: curve.map(r => ({x: r.triangles, y: speed(r)})).sort((a, b) => a.x - b.x)
                                    })));
    });
    return charts.some(c => c) && [
        el('p', {},
           'One model at several sizes: its triangles are split and displaced, so that the surface has detail at every size. With a hierarchy, ' +
               'ten times as many triangles cost a ray only a few more nodes, until they no longer fit a cache. Testing every triangle would make a ray ten times as expensive.'),
        grid(charts)
    ];
}

function lightSection() {
    const rows = records.filter(r => r.light && isOk(r));
    const charts =
        groups(rows, r => r.scene)
            .flatMap(
                scene => [['seconds', p => p.ms / 1000], ['samples a pixel', p => p.samples]].map(
                    ([unit, x]) => curveChart(
                        scene[0].scene, 'RMSE', unit,
                        scene.map(
                            r => ({label: label(r), color: color(r), points: r.light.points.map(p => ({x: x(p), y: p.rmse}))})))));
    const told = n => n === null ? 'not told' : String(n);
    const starts = records.filter(r => r.measure === 'start' && isOk(r));
    return (rows.length > 0 || starts.length > 0) && [
        el('p', {},
           'Pictures by paths of light, and their errors against a reference. With independent random numbers RMSE falls with the ' +
               'square root of the samples, a slope of \u22120.5; numbers that are spread evenly make it fall faster.'),
        grid(charts),
        rows.length > 0 &&
            table(
                ['scene', 'series', 'samples', 'RMSE', 'relMSE', 'slope', 'Msamples/s', 'bytes a path', 'registers', 'spilled bytes'], 2,
                rows.map(r => {
                    const l = r.light, last = l.points[l.points.length - 1];
                    return [
                        r.scene, label(r), String(last.samples), figure(last.rmse), figure(last.relmse), figure(l.slope),
                        figureOrNothing(l.msamples_per_s), figureOrNothing(l.state_bytes), told(l.registers), told(l.spilled_bytes)
                    ];
                })),
        starts.length > 0 &&
            table(
                ['scene', 'first picture', 'of that compiling, s', 'in all, s'], 2,
                starts.map(
                    r =>
                        [r.scene, label(r), figure(times(r, 'time_ms').p50 / 1000), figure(times(r, 'wall_ms').p50 / 1000)]))
    ];
}

function analysisSection() {
    const counted = groups(records.filter(r => r.analysis && isOk(r)), r => r.suite + '\n' + r.scene);
    const kind = r => ({primary: 'camera', reflection: 'mirrored'}[r.measure] || r.measure) + ' rays';
    const parts = data.looks.analysis.filter(look => look.meaning).map(look => {
        const charts =
            counted.filter(scene => scene.some(r => r.analysis[look.key] > 0))
                .map(
                    scene => barChart({
                        title: scene[0].scene,
                        unit: look.unit,
                        whole: look.scale === 100 ? 100 : 0,  // axes of percents reach to 100
                        groups:
                            groups(scene, r => r.measure).map(rows => ({
                                                                  title: kind(rows[0]),
                                                                  bars: rows.map(r => bar(r, look.scale * r.analysis[look.key]))
                                                              }))
                    }));
        return charts.length && [el('h3', {}, look.title), el('p', {}, look.meaning), grid(charts, ' three')];
    });
    const dropped =
        groups(records.filter(r => r.measure === 'dropped' && isOk(r)), r => [r.suite, r.scene, r.device].join('\n'))
            .map(scene => barChart({
                     title: scene[0].scene + onDevice(scene[0]),
                     unit: 'percent of the secondary rays, 4 steps',
                     groups: [{
                         bars: scene.map(r => {
                             const all = r.rays.secondary + r.dropped_rays;
                             return bar(r, all > 0 ? 100 * r.dropped_rays / all : 0, {
                                 label: plural(r.ray_slots, 'slot'),
                                 color: 0,
                                 hint: figure(r.dropped_rays) + ' of ' + figure(all) + ' rays'
                             });
                         })
                     }]
                 }));
    if (dropped.length)
        parts.push([
            el('h3', {}, 'Dropped rays'),
            el('p', {},
               'The thesis keeps the rays of a generation in arrays of a fixed size, because its graphics cards could not ' +
                   'allocate memory. Glass turns one ray into two. If the array is full, rays are dropped, and the pixel misses light. The figure is the share of dropped rays with 1, 2, 4 and 8 ' +
                   'slots a pixel; in 4 steps no pixel can need more than 8.'),
            grid(dropped, ' three')
        ]);
    return parts.some(p => p) && [
        el('p', {},
           'A second, slower program counts on the same rays, so that counting does not affect the times above. docs/bench.md defines every figure.'),
        parts
    ];
}

function leftOutSection() {
    const rows = [
        ...records.filter(r => !isOk(r)).map(r => [r.status, r.suite, r.case, label(r), r.why]),
        ...data.notes.map(note => ['left out', '', '', '', note])
    ];
    const parts = [
        data.failure &&
            el('p', {class: 'warn'},
               'The run ended early; the page shows the rows which were complete by then. The reason: ' + data.failure),
        data.interrupted &&
            el('p', {class: 'warn'}, 'The run was interrupted. The page shows the rows which were complete by then.'),
        table(['', 'suite', 'case', 'series', 'why'], 5, rows)
    ];
    return parts.some(p => p) && parts;
}

function machineSection() {
    const runs = data.runs, looks = data.looks;
    const span = pair => figure(pair.before) + ' to ' + figure(pair.after);
    const seen = new Map(records.filter(r => !r.peer || r.driver).map(r => [r.device + '\n' + r.driver, r]));
    const keys = ['fps', 'mrays_per_s', 'rays'];
    const rows = records.map(
        r =>
            [r.suite, r.case, label(r), (r.accel || '') + (r.accel_params ? ',' + r.accel_params : ''), r.status,
             hasFigures(r) ? String(repeats(r)) : '',
             ...['time_ms', 'wall_ms'].flatMap(clock => looks.times.map(look => figureOrNothing(times(r, clock)[look.key]))),
             figureOrNothing(r.fps), figureOrNothing(r.mrays_per_s), figureOrNothing(rays(r))]);
    return [
        table(
            ['run', 'date', 'version', 'command', 'processor', 'threads', 'governor', 'clock MHz', 'load', 'seconds'], 5,
            runs.map((run, i) => ([
                         String(i + 1), run.date, run.version, run.command, run.host_cpu, String(run.host_threads),
                         run.governor || 'not readable', run.clock_mhz.before > 0 ? span(run.clock_mhz) : 'not readable',
                         span(run.load), figure(run.seconds)
                     ]))),
        table(
            ['in the charts', 'device', 'id', 'driver', 'compute units'], 4,
            [...seen.values()].map(r => [r.peer ? 'peers' : device(r), r.device, r.device_id, r.driver, String(r.threads)])),
        el('p', {},
           'A figure is the p50 (the median) of many repetitions after a warm-up. Figures of one chart and one run were measured interleaved, A B A B, so that a disturbance of the ' +
               'machine affects all alike. The spread is the interquartile range divided by the median. If it stays above ' +
               percent(Math.max(0, ...runs.map(run => run.max_spread))) +
               ' after further attempts, the row is refused instead of shown. Kernels are timed by the device\u2019s clock, \u201call in\u201d by the host\u2019s. bench.json and bench.csv ' +
               'beside this page hold every figure.'),
        runs.length > 1 &&
            el('p', {}, 'This page joins ' + runs.length + ' runs. Rows of different runs were not measured interleaved.'),
        rows.length &&
            el('details', {}, el('summary', {}, 'All ' + plural(rows.length, 'row')),
               table(
                   [
                       'suite', 'case', 'series', 'structure', 'state', 'takes',
                       ...['kernels ', 'all in '].flatMap(
                           clock => looks.times.map(look => clock + look.title + ', ' + look.unit)),
                       ...keys.map(key => looks.record[key])
                   ],
                   5, rows))
    ];
}

const kSections = [
    ['thesis', 'Then and now', 'The thesis\u2019s tests, then and now', thesisSection],
    ['packets', 'Packets', 'Packets', packetsSection],
    ['structures', 'Structures and peers', 'Structures and peers', structuresSection],
    ['scale', 'How cost grows', 'How cost grows', scaleSection],
    ['light', 'Light', 'Paths of light', lightSection], ['analysis', 'Why', 'Why: what the tracer did', analysisSection], ['left-out', 'Left out', 'Left out', leftOutSection],
    ['machine', 'Machine and method', 'Machine and method', machineSection]
];
const sections = kSections.map(([id, link, title, make]) => ({id, link, title, content: make()})).filter(s => s.content);
document.title = 'Clarity bench' + (data.runs.length ? ', ' + clean(data.runs[0].date) : '');
document.body.append(
    el('h1', {}, 'Clarity bench'),
    el('p', {class: 'faint'},
       data.runs
           .map(
               run =>
                   [run.date + ', ' + run.host_cpu + ', ' + plural(run.host_threads, 'thread') + ', Clarity ' + run.version,
                    el('br')])
           .flat(),
       el('code', {}, data.command)),
    el('nav', {}, sections.map(s => el('a', {href: '#' + s.id}, s.link))),
    records.length ? '' : el('p', {}, 'Nothing was measured.'),
    ...sections.flatMap(s => [el('h2', {id: s.id}, s.title), ...[s.content].flat(Infinity).filter(part => part)]));
