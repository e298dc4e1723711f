// SPDX-License-Identifier: Apache-2.0
// Builds the report of a flight from its data. Data attributes of the root element state what is
// drawn: plots (their number), replay (drawn, flat or none).
'use strict';

(() => {
  const {el, number, withUnit} = Page;
  const {root, data, main, section, isolated} = Frame;

  // --- the flight and its metrics ---

  /** "8 of 9 limits met", or null. */
  function counts() {
    const limited = data.metrics.filter((m) => 'limit' in m);
    const kept = limited.filter((m) => m.ok).length;
    return limited.length ? `${kept} of ${limited.length} limits met` : null;
  }

  function metrics() {
    if (!data.metrics.length) return null;
    const limited = data.metrics.some((m) => 'limit' in m);
    const rows = data.metrics.map((m) => {
      const has = 'limit' in m;
      const limit = has ? withUnit(`${m.limit_is_least ? '\u2265' : '\u2264'}\u00a0${m.limit_text}`, m.unit) : '';
      return el('tr', {class: has ? (m.ok ? 'kept' : 'broken') : null},
                el('th', {scope: 'row', title: m.name}, isolated(m.label)),
                el('td', {class: 'number', title: m.value === null ? null : m.value},
                   m.text.replace(/^-/, '\u2212'),
                   el('span', {class: 'unit'}, m.unit ? `\u00a0${m.unit}` : '')),
                limited ? el('td', {class: 'number limit'}, limit.replace('-', '\u2212')) : null,
                limited ? el('td', {class: 'result'}, has ? (m.ok ? 'met' : 'violated') : '') : null);
    });
    return section('metrics', 'Metrics',
      el('div', {class: 'scroll'},
         el('table', {class: 'metrics'},
            el('thead', {}, el('tr', {}, el('th', {scope: 'col'}, 'Metric'),
                               el('th', {scope: 'col', class: 'number'}, 'Value'),
                               limited ? el('th', {scope: 'col', class: 'number'}, 'Limit') : null,
                               limited ? el('th', {scope: 'col', class: 'result'}, 'Result') : null)),
            el('tbody', {}, rows))));
  }

  function events(clock) {
    if (!data.events.length) return null;
    return section('events', 'Events',
      el('ol', {class: 'events'}, data.events.map((event) =>
        el('li', {},
           event.time === null ? el('span', {class: 'time'}, '\u2013')
             : el('button', {type: 'button', class: 'time', title: 'Show this instant',
                             onclick: () => clock.set(event.time)},
                  `${event.time.toFixed(2).replace(/^-/, '\u2212')}\u00a0s`),
           el('span', {}, el('b', {}, isolated(event.name)), event.detail ? ' ' : null,
              event.detail ? isolated(event.detail) : null)))));
  }

  // --- gains and margins ---

  function gains() {
    if (!data.gains.length) return null;
    return section('gains', 'Gains', data.gains.map((table) =>
      el('div', {class: 'scroll'},
         el('table', {class: 'matrix'},
            el('caption', {}, isolated(table.title)),
            el('thead', {}, el('tr', {}, el('td'),
               table.columns.map((c) => el('th', {scope: 'col', class: 'number'}, isolated(c))))),
            el('tbody', {}, table.values.map((row, i) =>
              el('tr', {}, el('th', {scope: 'row'}, isolated(table.rows[i])),
                 row.map((v) => el('td', {class: v === 0 ? 'number zero' : 'number',
                                          title: v === null ? null : v}, number(v, 5))))))))));
  }

  function margins() {
    if (!data.margins.length) return null;
    const heads = [];
    for (const row of data.margins)
      for (const {name, unit} of row.values)
        if (!heads.some((h) => h.name === name && h.unit === unit)) heads.push({name, unit});
    return section('margins', 'Margins',
      el('div', {class: 'scroll'},
         el('table', {class: 'matrix'},
            el('thead', {}, el('tr', {}, el('th', {scope: 'col'}, 'loop'),
               heads.map((h) => el('th', {scope: 'col', class: 'number'}, isolated(h.name),
                                   h.unit ? el('span', {class: 'unit'}, ` [${h.unit}]`) : null)))),
            el('tbody', {}, data.margins.map((row) =>
              el('tr', {}, el('th', {scope: 'row'}, isolated(row.loop)),
                 heads.map((h) => {
                   const value = row.values.find((v) => v.name === h.name && v.unit === h.unit);
                   return el('td', {class: 'number'},
                             value ? value.text.replace(/^-/, '\u2212') : '\u2013');
                 })))))));
  }

  // --- the page ---

  const flown = data.time ? Page.float64(data.time)
                          : data.replay ? Page.float64(data.replay.time) : [0];
  const clock = Page.makeClock(flown[0], flown[flown.length - 1]);

  main.append(
    Frame.header('Flight report', data.title || 'Flight',
                 Frame.verdict({pass: 'Pass', fail: 'Fail', none: 'No verdict'}, counts())),
    el('div', {class: 'summary'}, metrics(),
       el('div', {class: 'beside'}, Frame.about('Flown', data.about), events(clock))));

  const flight = el('div', {class: 'flight'});
  main.append(flight);

  let replay = null;
  if (data.replay) {
    const host = section('replay', 'Replay');
    flight.append(host);
    replay = Replay.draw(data, clock, host);
    Frame.add(replay);
  }

  const plots = Frame.plots(flight, clock, 'Plots',
    'Over time in s. Drag to zoom, double-click for the whole flight.', 'Whole flight');
  flight.classList.toggle('both', replay !== null && plots !== null);
  main.append(...[gains(), margins(), Frame.origin('uPlot and three.js')].filter((part) => part !== null));

  clock.set(clock.first);
  // For scripts that capture a certain instant or check positions in the picture.
  window.flightReport = {seek: clock.set, replay};

  // uPlot draws after this task.
  setTimeout(() => {
    root.dataset.plots = String(plots ? plots.count() : 0);
    root.dataset.replay = replay ? replay.kind : 'none';
  });
})();
