// SPDX-License-Identifier: Apache-2.0
// Plots over time with uPlot: one cursor, which is the clock, and one zoom for all.
'use strict';

const Plots = (() => {
  const {el, float32, float64, indexAt, fixed, color} = Page;

  const kColors = 6;     // --series-1 … --series-6
  const kHeight = 190;   // of a plot [px]
  const kPrintSize = {width: 686, height: 160};
  const kManyEvents = 30;   // from this number on their lines are faint
  const kLeastSpan = 0.01;  // minimum span of the zoom [s]

  /**
   * The colour, dashes and width of a series: references and estimates follow their value. The
   * first band is an area; a further band is the outline of the comparison.
   */
  function looks(series) {
    const count = {value: 0, reference: 0, estimate: 0, measurement: 0, band: 0};
    const values = series.filter((s) => s.style === 'value').length;
    return series.map((s) => {
      const n = count[s.style]++;
      if (s.style === 'band')
        return n === 0 ? {tone: 'muted', dash: [], width: 1, area: true}
                       : {tone: 'ink', dash: [2, 4], width: 1};
      // With at most one value, colours distinguish the styles as well.
      const alone = values <= 1 && s.style !== 'value';
      const shift = {reference: 'ink', estimate: 2, measurement: 3}[s.style];
      let tone = `series-${(n % kColors) + 1}`;
      if (alone && s.style === 'reference' && n === 0) tone = shift;
      else if (alone && s.style !== 'reference') tone = `series-${((n + shift - 1) % kColors) + 1}`;
      const dash = {value: [], reference: [7, 5], estimate: [2, 3], measurement: []}[s.style];
      const width = {value: 1.75, reference: 1.25, estimate: 1.5, measurement: 0}[s.style];
      return {tone, dash, width};
    });
  }

  /** Whether most values are isolated between gaps, as for a slow sensor in a fast log. */
  function isSparse(values) {
    let alone = 0;
    let all = 0;
    for (let i = 0; i < values.length; ++i) {
      if (values[i] === null) continue;
      ++all;
      if ((i === 0 || values[i - 1] === null) && (i + 1 >= values.length || values[i + 1] === null))
        ++alone;
    }
    return all > 1 && alone > all / 2;
  }

  /** The value at a row; for a sparse series the most recent one. */
  function valueAt(values, row, sparse) {
    if (!sparse) return values[row];
    for (let i = row; i >= 0; --i) if (values[i] !== null) return values[i];
    return null;
  }

  /** The number of decimals that distinguishes values which the plot distinguishes. */
  function decimalsOf(series) {
    let low = Infinity;
    let high = -Infinity;
    for (const {values} of series)
      for (const v of values) {
        if (v === null) continue;
        low = Math.min(low, v);
        high = Math.max(high, v);
      }
    const size = high > low ? high - low : Math.abs(high);
    return size > 0 && size < Infinity ? Math.min(Math.max(3 - Math.ceil(Math.log10(size)), 0), 9) : 1;
  }

  /** A sample of the line of a series, for the legend. */
  function swatch(look, dots) {
    const ns = 'http://www.w3.org/2000/svg';
    const svg = document.createElementNS(ns, 'svg');
    svg.setAttribute('viewBox', '0 0 24 8');
    svg.setAttribute('class', 'swatch');
    svg.setAttribute('aria-hidden', 'true');
    const shape = (name, attributes) => {
      const node = document.createElementNS(ns, name);
      for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
      node.setAttribute('class', `tone-${look.tone}`);
      svg.append(node);
    };
    if (look.area)
      shape('rect', {x: 0, y: 0, width: 24, height: 8, 'fill-opacity': 0.25, stroke: 'none'});
    else if (dots)
      for (const x of [4, 12, 20]) shape('circle', {cx: x, cy: 4, r: 2});
    else
      shape('line', {x1: 0, x2: 24, y1: 4, y2: 4, 'stroke-width': look.width + 0.5,
                     'stroke-dasharray': look.dash.join(' ')});
    return svg;
  }

  /** Draws all plots, at least one, into a host; returns an object that acts on all of them. */
  function draw(data, clock, host) {
    const time = float64(data.time);
    const columns = data.columns.map((c) =>
      Array.from(float32(c), (v) => (Number.isFinite(v) ? v : null)));
    const full = {min: time[0], max: time.length > 1 ? time[time.length - 1] : time[0] + 1};
    const plots = [];
    const zoomListeners = [];
    let following = false;  // a plot is being synchronized with another one
    const drawn = new Set();

    function zoom(min, max, source) {
      following = true;
      for (const {u} of plots) if (u !== source) u.setScale('x', {min, max});
      following = false;
      for (const listener of zoomListeners)
        listener(min > full.min || max < full.max);
    }

    /** Zooms all plots around the time of the clock. */
    function zoomBy(factor) {
      const {min, max} = plots[0].u.scales.x;
      const span = Math.max((max - min) * factor, kLeastSpan);
      const at = Math.min(Math.max(clock.time, min), max);
      const low = Math.max(at - ((at - min) / (max - min)) * span, full.min);
      zoom(low, Math.min(low + span, full.max), null);
    }

    function follow(plot, t) {
      const {u, series, shown, decimals} = plot;
      const {min, max} = u.scales.x;
      const inside = t >= min && t <= max;
      const left = inside ? u.valToPos(t, 'x') : -10;
      u.setCursor({left, top: inside ? 1 : -10}, false);
      let row = indexAt(time, t);
      if (row + 1 < time.length && time[row + 1] - t < t - time[row]) ++row;
      series.forEach((s, i) => {
        const value = valueAt(s.values, row, s.sparse);
        if (!s.upper) {
          shown[i].textContent = fixed(value, decimals);
          return;
        }
        // The half width of a band.
        const above = valueAt(s.upper, row, s.sparse);
        const known = value !== null && above !== null;
        shown[i].textContent = known ? `\u00b1${fixed((above - value) / 2, decimals)}` : '\u2013';
      });
    }

    function onKey(event) {
      const step = (plots[0].u.scales.x.max - plots[0].u.scales.x.min) / (event.shiftKey ? 20 : 200);
      const actions = {
        ArrowLeft: () => clock.set(clock.time - step),
        ArrowRight: () => clock.set(clock.time + step),
        Home: () => clock.set(full.min),
        End: () => clock.set(full.max),
        '+': () => zoomBy(0.5),
        '=': () => zoomBy(0.5),
        '-': () => zoomBy(2),
        '0': () => zoom(full.min, full.max, null),
        Escape: () => zoom(full.min, full.max, null),
        ' ': () => (clock.playing ? clock.pause() : clock.play()),
      };
      if (event.ctrlKey || event.metaKey || event.altKey || !actions[event.key]) return;
      if (event.target.closest('button')) return;
      event.preventDefault();
      actions[event.key]();
    }

    for (const plot of data.plots) {
      const styles = looks(plot.series);
      const factor = plot.factor ?? 1;
      const series = plot.series.map((s, i) => {
        const scaled = (column) => column.map((v) =>
          v === null || (plot.logarithmic && !(v > 0)) ? null : v * factor);
        const values = scaled(columns[s.column]);
        const upper = s.style === 'band' ? scaled(columns[s.upper]) : null;
        const sparse = isSparse(values);
        const dots = s.style === 'measurement' || (sparse && !upper);
        return {...s, look: styles[i], sparse, dots, values, upper};
      });
      // Dots are drawn below lines and above areas; the keys keep the order of the report. Each edge
      // of a band is a separate line.
      const depth = (s) => (s.upper ? 0 : s.dots ? 1 : 2);
      const layers = [...series].sort((a, b) => depth(a) - depth(b))
        .flatMap((s) => (s.upper ? [{...s, values: s.upper, of: s}, {...s, of: s}] : [{...s, of: s}]));
      const areas = layers.flatMap((s, i) => (s.look.area && s.values === s.upper
        ? [{series: [i + 1, i + 2], fill: () => `${color(s.look.tone)}33`}] : []));
      const shown = series.map((s) => el('span', {class: 'reading'}));
      const keys = series.map((s, i) => {
        const button = el('button', {type: 'button', class: 'key', 'aria-pressed': String(!s.hidden),
                                     title: `Show or hide ${s.label}`},
                          swatch(s.look, s.dots), el('bdi', {class: 'name'}, s.label), shown[i]);
        button.addEventListener('click', () => {
          const on = button.getAttribute('aria-pressed') !== 'true';
          button.setAttribute('aria-pressed', String(on));
          layers.forEach((layer, at) => {
            if (layer.of === series[i]) u.setSeries(at + 1, {show: on});
          });
        });
        return button;
      });
      const canvas = el('div', {class: 'plot-canvas'});
      const figure = el('figure', {class: 'plot', tabindex: '0', onkeydown: onKey},
                        el('figcaption', {},
                           el('h3', {}, el('bdi', {}, plot.title),
                              plot.unit ? el('span', {class: 'unit'}, ` [${plot.unit}]`) : null),
                           el('div', {class: 'keys'}, keys)),
                        canvas);
      figure.setAttribute('aria-label', `${plot.title}: arrow keys move the time, plus and minus ` +
                                        'zoom, 0 shows all');
      host.append(figure);

      const axis = {
        stroke: () => color('muted'),
        grid: {stroke: () => color('grid'), width: 1},
        ticks: {stroke: () => color('grid'), width: 1, size: 4},
        font: '12px system-ui, sans-serif',
        gap: 4,
      };
      const options = {
        width: Math.max(canvas.clientWidth, 200),
        height: kHeight,
        legend: {show: false},
        padding: [8, 16, 0, 0],
        scales: {x: {time: false, range: (u, min, max) => (min < max ? [min, max] : [min, min + 1])},
                 y: plot.logarithmic ? {distr: 3} : {}},
        bands: areas,
        axes: [{...axis, size: 26, space: 60},
               // Equal widths, so that an instant is at the same position in every plot.
               {...axis, size: 58, space: 28,
                values: (u, splits) => splits.map((v) => (v === null ? '' : Page.tick(v)))}],
        cursor: {y: false, drag: {x: true, y: false, dist: 4}, points: {size: 6},
                 // The cursor is the clock: it stays where the mouse left it.
                 bind: {mouseleave: () => null}},
        series: [{}, ...layers.map((s) => ({
          label: s.label,
          stroke: () => color(s.look.tone),
          fill: undefined,
          show: !s.hidden,
          width: s.look.width || 1,
          dash: s.look.dash,
          paths: s.dots ? () => null : undefined,
          points: s.dots ? {show: true, size: 3, width: 0, fill: () => color(s.look.tone)}
                         : {show: false},
        }))],
        hooks: {
          draw: [(u) => drawn.add(u)],
          setCursor: [(u) => {
            if (u.cursor.left >= 0 && !clock.playing && !following)
              clock.set(u.posToVal(u.cursor.left, 'x'));
          }],
          setScale: [(u, key) => {
            if (key !== 'x' || following) return;
            zoom(u.scales.x.min, u.scales.x.max, u);
            clock.set(clock.time);
          }],
          drawAxes: [(u) => {
            const {ctx, bbox} = u;
            ctx.save();
            ctx.strokeStyle = color('event');
            ctx.lineWidth = devicePixelRatio;
            ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
            if (data.events.length > kManyEvents) ctx.globalAlpha = 0.35;
            for (const event of data.events) {
              if (event.time === null) continue;
              if (event.time < u.scales.x.min || event.time > u.scales.x.max) continue;
              const x = Math.round(u.valToPos(event.time, 'x', true)) + 0.5;
              ctx.beginPath();
              ctx.moveTo(x, bbox.top);
              ctx.lineTo(x, bbox.top + bbox.height);
              ctx.stroke();
            }
            ctx.restore();
          }],
        },
      };
      const u = new uPlot(options, [time, ...layers.map((s) => s.values)], canvas);
      const touch = (event) => {
        const box = u.over.getBoundingClientRect();
        if (!clock.playing) clock.set(u.posToVal(event.touches[0].clientX - box.left, 'x'));
      };
      u.over.addEventListener('touchstart', touch, {passive: true});
      u.over.addEventListener('touchmove', touch, {passive: true});
      plots.push({u, series, shown, canvas, decimals: decimalsOf(series)});
    }

    let printing = false;
    const observer = new ResizeObserver(() => {
      if (printing) return;
      for (const {u, canvas} of plots) {
        const width = Math.floor(canvas.clientWidth);
        if (width > 0 && width !== u.width) u.setSize({width, height: kHeight});
      }
      clock.set(clock.time);
    });
    for (const {canvas} of plots) observer.observe(canvas);

    clock.listen((t) => {
      for (const plot of plots) follow(plot, t);
    });

    return {
      count: () => drawn.size,
      zoomed: (listener) => zoomListeners.push(listener),
      reset: () => zoom(full.min, full.max, null),
      restyle: () => { for (const {u} of plots) u.redraw(false, true); },
      print(on) {
        printing = on;
        for (const {u, canvas} of plots)
          u.setSize(on ? kPrintSize : {width: Math.max(canvas.clientWidth, 200), height: kHeight});
      },
    };
  }

  return {draw};
})();
