// SPDX-License-Identifier: Apache-2.0
// Builds the report of a campaign from its data. The root element's data-cells is the number of small
// charts that are drawn.
'use strict';

(() => {
  const {el, number} = Page;
  const {root, data, main, section, isolated} = Frame;

  const figure = (v) => (v === 'never' ? 'never' : number(v, 3));
  const cellOf = (v, more = {}) => el('td', {class: 'number', title: v, ...more}, figure(v));
  const percent = (share) => `${number(100 * share, 4)}\u00a0%`;
  const head = (text, numeric = true) => el('th', {scope: 'col', class: numeric ? 'number' : null}, text);
  const table = (heads, rows) =>
    el('div', {class: 'scroll'},
       el('table', {class: 'matrix wide'}, el('thead', {}, el('tr', {}, heads)), el('tbody', {}, rows)));

  function summary() {
    return section('success', 'Success',
      table([head('Design', false), head('Mission', false), head('Flights'), head('Pass'), head('Share'),
             head('95 % from'), head('to'), head('Ends', false)],
            data.cases.map((c) =>
              el('tr', {},
                 el('th', {scope: 'row'}, isolated(c.design)), el('td', {}, isolated(c.mission)),
                 cellOf(c.flights), cellOf(c.passed),
                 el('td', {class: 'number found'}, percent(c.rate)),
                 el('td', {class: 'number'}, percent(c.low)), el('td', {class: 'number'}, percent(c.high)),
                 el('td', {class: 'ends'}, c.ends.map(([end, count]) => `${count} ${end}`).join(', '))))));
  }

  const titleOf = (c) => `${c.design} in ${c.mission}`;

  function spread(c, index) {
    return section(`metrics-${index}`, titleOf(c),
      el('p', {class: 'hint'}, isolated(c.law)),
      table([head('Metric', false), head('5 %'), head('Median'), head('95 %'), head('99 %'), head('Limit'),
             head('Unit', false)],
            c.metrics.map((m) =>
              el('tr', {},
                 el('th', {scope: 'row'}, isolated(m.label)),
                 cellOf(m.p05), el('td', {class: 'number found', title: m.median}, figure(m.median)),
                 cellOf(m.p95), cellOf(m.p99), cellOf(m.limit), el('td', {}, isolated(m.unit))))));
  }

  function trends(c, index) {
    if (!c.trends.quantities.length) return null;
    const tone = (v) => v === null ? null
      : `number heat-${Math.min(5, Math.ceil(5 * Math.abs(v)))} ${v > 0 ? 'rises' : 'falls'}`;
    return section(`trends-${index}`, `What ${titleOf(c)} depends on`,
      el('p', {class: 'hint'}, 'Rank correlation of the drawn parameters with each metric, if significantly '
         + 'different from 0: 1 increases monotonically, \u22121 decreases.'),
      table([head('', false), c.trends.figures.map((f) => head(f))],
            c.trends.quantities.map((q, i) =>
              el('tr', {}, el('th', {scope: 'row'}, isolated(q)),
                 c.trends.values[i].map((v) =>
                   el('td', {class: tone(v) ?? 'number'}, v === null ? '' : number(v, 2)))))));
  }

  function worst() {
    const rows = data.cases.flatMap((c) => c.worst.map((w) =>
      el('tr', {}, el('th', {scope: 'row'}, isolated(titleOf(c))), el('td', {}, isolated(w.why)),
         el('td', {}, el('code', {}, isolated(w.command))))));
    return rows.length ? section('worst', 'Worst flights',
      table([head('Case', false), head('Why', false), head('Command', false)], rows)) : null;
  }

  function comparisons() {
    return data.comparisons.map((c, index) =>
      section(`comparison-${index}`, c.title,
        el('p', {class: 'hint'}, isolated(c.passes)),
        c.differences.length
          ? table([head('Metric', false), head('Mean'), head('95 % from'), head('to'), head('Unit', false), head('Draws')],
                  c.differences.map((d) =>
                    el('tr', {}, el('th', {scope: 'row'}, isolated(d.label)),
                       el('td', {class: 'number found', title: d.mean}, number(d.mean, 3)),
                       cellOf(d.low), cellOf(d.high), el('td', {}, isolated(d.unit)), cellOf(d.draws))))
          : el('p', {class: 'note'}, 'No metric differs significantly.')));
  }

  main.append(Frame.header('Campaign', data.title || 'Campaign'),
              summary(), ...data.cases.map(spread));
  if (data.distributions.length) {
    const host = el('div', {class: 'cells'});
    const designs = [...new Set(data.cases.map((c) => c.design))];
    main.append(section('distributions', 'Distributions of the metrics',
      el('p', {class: 'hint'}, 'Share of the flights below a value in %. Dashes: the mission\u2019s limit.'),
      designs.length > 1
        ? el('div', {class: 'key-list designs'},
             designs.map((d, i) => el('span', {class: 'key-item'},
                                      el('i', {class: `line tone-series-${i % 6 + 1}`}), isolated(d)))) : null,
      host));
    for (const d of data.distributions)
      Cells.distribution(host, [isolated(d.label), d.unit ? el('span', {class: 'unit'}, ' [', isolated(d.unit), ']') : null,
                                data.cases.some((c) => c.mission !== d.mission)
                                  ? [', ', isolated(d.mission)] : null],
                         {...d, curves: d.curves.map((c) => ({x: c.x, reached: c.reached, tone: designs.indexOf(c.design) % 6 + 1}))});
    Frame.add(Cells);
  }
  main.append(...comparisons(), ...data.cases.map(trends).filter((part) => part !== null));
  const last = [worst(), Frame.about('Drawn parameters', data.about), Frame.origin('uPlot')];
  main.append(...last.filter((part) => part !== null));

  // uPlot draws after this task.
  setTimeout(() => { root.dataset.cells = String(Cells.count()); });
})();
