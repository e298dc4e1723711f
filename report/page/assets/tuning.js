// SPDX-License-Identifier: Apache-2.0
// Builds the report of the tuning of a filter from its data. The root element's data-plots is the number
// of plots over time that are drawn, data-cells that of small charts.
'use strict';

(() => {
  const {el, number, withUnit} = Page;
  const {root, data, main, section, isolated} = Frame;

  const cellOf = (text, more = {}) => el('td', {class: 'number', ...more}, text);
  const value = (v) => cellOf(number(v), {title: v});

  // --- tables ---

  function parameters() {
    const heads = ['Before', 'Found', '95 % from', 'to'];
    return section('parameters', 'Noise',
      el('div', {class: 'scroll'},
         el('table', {class: 'matrix wide'},
            el('thead', {}, el('tr', {}, el('th', {scope: 'col'}, 'Parameter'),
               heads.map((h) => el('th', {scope: 'col', class: 'number'}, h)),
               el('th', {scope: 'col'}, 'Unit'), el('th', {scope: 'col'}, ''))),
            el('tbody', {}, data.parameters.map((p) =>
              el('tr', {class: p.doubtful ? 'broken' : null},
                 el('th', {scope: 'row'}, isolated(p.name)),
                 value(p.before),
                 el('td', {class: 'number found', title: p.value}, number(p.value)),
                 value(p.low), value(p.high),
                 el('td', {}, isolated(p.unit)),
                 el('td', {class: 'result'}, p.verdict)))))),
      data.unseen.map((text) => el('p', {class: 'note'}, isolated(text))));
  }

  function checks() {
    if (!data.checks.length) return null;
    const heads = ['Samples', 'Size before', 'Size', 'Mean', 'Correlation', 'at lag', 'Kurtosis'];
    return section('checks', 'Innovations',
      el('div', {class: 'scroll'},
         el('table', {class: 'matrix wide'},
            el('thead', {}, el('tr', {}, el('th', {scope: 'col'}, 'Output'),
               heads.map((h) => el('th', {scope: 'col', class: 'number'}, h)),
               el('th', {scope: 'col'}, ''))),
            el('tbody', {}, data.checks.map((c) =>
              el('tr', {class: c.failed.length ? 'broken' : null},
                 el('th', {scope: 'row'}, isolated(c.output)),
                 value(c.samples), value(c.size_before), value(c.size), value(c.mean),
                 value(c.correlation), value(c.lag), value(c.kurtosis),
                 el('td', {class: 'result'}, c.failed.join(', '))))))),
      el('p', {class: 'note'},
         'Size is the mean of e²/S, 1 if the covariances are right; mean and kurtosis are then 0. '
         + 'Correlation is the largest at the first lags.'));
  }

  // --- charts ---

  const grid = () => el('div', {class: 'cells'});

  function correlations(place) {
    if (!data.correlations.length) return;
    const host = grid();
    place.append(section('whiteness', 'Autocorrelation of the innovations',
      el('p', {class: 'hint'}, 'Over the lag in samples. Bars: after; circles: before; white noise stays '
         + 'within the grey band at 95 % of the lags.'), host));
    for (const c of data.correlations) Cells.correlation(host, isolated(c.output), c);
  }

  function profiles(place) {
    if (!data.profiles.length) return;
    const host = grid();
    place.append(section('profiles', 'Profile of the likelihood',
      el('p', {class: 'hint'}, 'Log-likelihood over one parameter, maximized over the others, relative to its '
         + 'maximum. Solid line: estimate; dashes: before, if in range; area: 95 % interval; dots: its level.'), host));
    for (const p of data.profiles)
      Cells.profile(host, [isolated(p.name), p.unit ? el('span', {class: 'unit'}, ' [', isolated(p.unit), ']') : null],
                    p);
  }

  // --- the page ---

  const time = data.time ? Page.float64(data.time) : [0];
  const clock = Page.makeClock(time[0], time[time.length - 1]);

  main.append(
    Frame.header('Filter tuning', data.title || 'Filter',
                 Frame.verdict({pass: 'Pass', fail: 'Fail', none: 'Too short for a verdict'}, null)),
    el('div', {class: 'summary'}, parameters(), el('div', {class: 'beside'}, Frame.about('Logs and fit', data.about))));
  main.append(...[checks()].filter((part) => part !== null));
  const charts = el('div', {class: 'summary'});
  main.append(charts);
  correlations(charts);
  profiles(charts);
  Frame.add(Cells);

  const plots = Frame.plots(main, clock, 'Over time',
    ['Over time in s. Drag to zoom, double-click for the whole log.', ...data.remarks].join(' '), 'Whole log');
  main.append(Frame.origin('uPlot'));
  clock.set(clock.first);

  // uPlot draws after this task.
  setTimeout(() => {
    root.dataset.plots = String(plots ? plots.count() : 0);
    root.dataset.cells = String(Cells.count());
  });
})();
