// SPDX-License-Identifier: Apache-2.0
// Puts the report together from its data. What it has drawn is told in data attributes of the root
// element: plots (how many), replay (drawn, flat or none), error (the first that was thrown).
'use strict';

(() => {
  const {el, number, withUnit} = Page;
  const root = document.documentElement;

  window.addEventListener('error', (event) => {
    root.dataset.error ??= String(event.message);
  });
  window.addEventListener('unhandledrejection', (event) => {
    root.dataset.error ??= String(event.reason);
  });

  const data = JSON.parse(document.getElementById('data').textContent);
  const main = document.getElementById('report');

  const section = (id, title, ...children) =>
    el('section', {id, 'aria-labelledby': `${id}-title`}, el('h2', {id: `${id}-title`}, title), children);
  const isolated = (text) => el('bdi', {}, text);

  // --- what was flown, and how well ---

  function verdict() {
    const words = {pass: 'Pass', fail: 'Fail', none: 'No verdict'};
    const limited = data.metrics.filter((m) => 'limit' in m);
    const kept = limited.filter((m) => m.ok).length;
    const counts = limited.length ? `${kept} of ${limited.length} limits kept` : null;
    return el('div', {class: `verdict ${data.verdict}`},
              el('strong', {}, words[data.verdict]),
              el('div', {},
                 counts ? el('p', {class: 'counts'}, counts) : null,
                 data.reasons.map((reason) => el('p', {}, isolated(reason)))));
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
                limited ? el('td', {class: 'result'}, has ? (m.ok ? 'kept' : 'broken') : '') : null);
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

  function about() {
    const pairs = [...data.about];
    if (data.seed && !pairs.some(([key]) => key.toLowerCase() === 'seed')) pairs.push(['seed', data.seed]);
    if (!pairs.length) return null;
    return section('about', 'Flown',
      el('dl', {}, pairs.map(([key, value]) => [el('dt', {}, isolated(key)), el('dd', {}, isolated(value))])));
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

  function origin() {
    const sentence = data.rows > data.kept
      ? `Plots show ${data.kept} of ${data.rows} rows: least and greatest value of each interval.`
      : data.kept ? `Plots show all ${data.rows} rows.` : null;
    return el('footer', {},
      data.command ? el('p', {}, 'Made by ', el('code', {}, isolated(data.command))) : null,
      el('p', {}, [data.version ? `quadtune ${data.version}.` : 'quadtune.',
                   data.seed ? `Seed ${data.seed}.` : null, sentence,
                   'This file loads nothing. It contains uPlot and three.js under the MIT licence.']
                  .filter((s) => s !== null).join(' ')));
  }

  // --- light and dark ---

  const prefersDark = matchMedia('(prefers-color-scheme: dark)');
  let theme = prefersDark.matches ? 'dark' : 'light';
  const themed = [];  // what has colours of its own
  const themeButton = el('button', {type: 'button', class: 'theme'});
  function paint(name) {
    root.dataset.theme = name;
    const other = name === 'dark' ? 'light' : 'dark';
    themeButton.textContent = other === 'dark' ? 'Dark' : 'Light';
    themeButton.setAttribute('aria-label', `Change to ${other} colours`);
    for (const part of themed) part.restyle();
  }
  themeButton.addEventListener('click', () => {
    theme = theme === 'dark' ? 'light' : 'dark';
    paint(theme);
  });
  prefersDark.addEventListener('change', () => {
    theme = prefersDark.matches ? 'dark' : 'light';
    paint(theme);
  });
  paint(theme);

  // --- all together ---

  const flown = data.time ? Page.float64(data.time)
                          : data.replay ? Page.float64(data.replay.time) : [0];
  const clock = Page.makeClock(flown[0], flown[flown.length - 1]);

  main.append(
    el('header', {},
       el('div', {class: 'kicker'}, el('span', {}, 'Flight report'), themeButton),
       el('h1', {}, isolated(data.title || 'Flight')),
       verdict()),
    el('div', {class: 'summary'}, metrics(),
       el('div', {class: 'beside'}, about(), events(clock))));

  const flight = el('div', {class: 'flight'});
  main.append(flight);

  let replay = null;
  if (data.replay) {
    const host = section('replay', 'Replay');
    flight.append(host);
    replay = Replay.draw(data, clock, host);
    themed.push(replay);
  }

  const reset = el('button', {type: 'button', class: 'reset', disabled: true}, 'Whole flight');
  const host = section('plots', 'Plots');
  let plots = null;
  if (data.plots.length) {
    host.append(el('div', {class: 'hint'}, 'Over time in s. Drag to zoom, double-click for the whole flight.', reset));
    flight.append(host);
    plots = Plots.draw(data, clock, host);
    themed.push(plots);
    plots.zoomed((zoomed) => { reset.disabled = !zoomed; });
    reset.addEventListener('click', () => {
      plots.reset();
      clock.set(clock.time);
    });
  }
  flight.classList.toggle('both', replay !== null && plots !== null);
  main.append(...[gains(), margins(), origin()].filter((part) => part !== null));

  // Paper is white.
  window.addEventListener('beforeprint', () => {
    paint('light');
    plots?.print(true);
    replay?.print(true);
  });
  window.addEventListener('afterprint', () => {
    plots?.print(false);
    replay?.print(false);
    paint(theme);
  });

  clock.set(clock.first);
  // For scripts that take pictures of a certain instant or check where things are.
  window.flightReport = {seek: clock.set, replay};

  // uPlot draws at the end of this task.
  setTimeout(() => {
    root.dataset.plots = String(plots ? plots.count() : 0);
    root.dataset.replay = replay ? replay.kind : 'none';
  });
})();
