// SPDX-License-Identifier: Apache-2.0
// Builds the report of gains that were tuned over missions from its data. The root element's
// data-plots is the number of plots over time that are drawn, data-cells that of small charts.
'use strict';

(() => {
  const {el, number} = Page;
  const {root, data, main, section, isolated} = Frame;

  const figure = (v) => (v === 'never' ? 'never' : number(v));
  const head = (text, kind = 'number') => el('th', {scope: 'col', class: kind}, text);

  /** A cell with a value; a cross marks a violated limit, so that it does not depend on colour. */
  function cell(row, column) {
    const broken = row.broken[column];
    const kind = ['number', column === 1 ? 'found' : '', broken ? 'broken' : ''].join(' ').trim();
    return el('td', {class: kind, title: row.values[column]},
              broken ? el('span', {title: 'violates the limit'}, '\u2717\u00a0') : null,
              figure(row.values[column]));
  }

  /** The state of a limit: "violated", "binding" or "met". */
  const result = (row) => (row.limit === null ? ''
    : row.broken[1] ? 'violated' : row.binds ? 'binding' : 'met');

  function compared(table) {
    if (!table.rows.length) return null;
    const limited = table.rows.some((row) => row.limit !== null);
    return section(table.id || 'table', table.title,
      table.hint ? el('p', {class: 'hint'}, isolated(table.hint)) : null,
      el('div', {class: 'scroll'},
         el('table', {class: 'matrix wide compared'},
            el('thead', {}, el('tr', {}, head('', null), head('', null),
               data.columns_of.map((name) => head(isolated(name))),
               limited ? [head('limit'), head('', 'result')] : null)),
            el('tbody', {}, table.rows.map((row, i) => {
              const first = i === 0 || table.rows[i - 1].of !== row.of;
              return el('tr', {class: [first ? 'first' : '', row.binds ? 'binds' : '', row.main ? 'main' : ''].join(' ').trim() || null},
                        el('td', {class: 'of'}, first ? isolated(row.of) : ''),
                        el('th', {scope: 'row'}, isolated(row.label),
                           row.unit ? el('span', {class: 'unit'}, ' ', isolated(row.unit)) : null),
                        data.columns_of.map((_, column) => cell(row, column)),
                        limited
                          ? [el('td', {class: 'number limit', title: row.limit},
                                row.limit === null ? '' : `${row.at_least ? '\u2265' : '\u2264'}\u00a0${figure(row.limit)}`),
                             el('td', {class: 'result'}, result(row))] : null);
            })))));
  }

  function search() {
    if (!data.search.evaluation.length) return null;
    const host = el('div', {class: 'cells'});
    const part = section('search', 'Search',
      el('div', {class: 'hint'},
         el('span', {}, 'Cost on the draws of the search. Dots: feasible points that were evaluated; line: minimum so far.')), host);
    return {part, draw: () => Cells.search(host, 'Cost over evaluations', data.search)};
  }

  /** The plots of the missions, each over its own time. */
  function flown() {
    if (!data.flown.length) return [];
    const host = el('div', {class: 'summary'});
    main.append(section('flown', 'One flight of each controller',
      el('div', {class: 'hint'},
         'The first fresh draw, with the same noise and wind for each. Over time in s; drag to zoom, double-click to show all.'),
      host));
    return data.flown.map((one) => {
      const place = el('div', {});
      host.append(place);
      const time = Page.float64(one.time);
      const clock = Page.makeClock(time[0], time[time.length - 1]);
      const drawing = Plots.draw(one, clock, place);
      Frame.add(drawing);
      clock.set(clock.first);
      return drawing;
    });
  }

  // --- the page ---

  main.append(Frame.header('Gains over missions', data.title || 'Gains',
    Frame.verdict({pass: 'Accepted', fail: 'Not accepted', none: 'No verdict'}, data.counts ? isolated(data.counts) : null)));
  const [first, second, ...rest] = data.tables.map(compared);
  main.append(el('div', {class: 'summary tables'}, first ?? null, second ?? null));
  const searched = search();
  main.append(el('div', {class: 'summary'},
                 el('div', {}, searched ? searched.part : null, Frame.about('Request', data.about)),
                 rest.filter((part) => part !== null)));
  if (searched) searched.draw();
  Frame.add(Cells);
  const flights = flown();
  main.append(Frame.origin('uPlot'));

  // uPlot draws after this task.
  setTimeout(() => {
    root.dataset.plots = String(flights.reduce((sum, drawing) => sum + drawing.count(), 0));
    root.dataset.cells = String(Cells.count());
  });
})();
