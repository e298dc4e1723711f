// SPDX-License-Identifier: Apache-2.0
// Small charts side by side, without a clock: bars over lags, curves over a parameter.
'use strict';

const Cells = (() => {
  const {el, color, tick} = Page;

  const kHeight = 150;  // of a chart [px]
  const kPrintSize = {width: 215, height: 120};

  const all = [];
  const drawn = new Set();

  function axis(more) {
    return {
      stroke: () => color('muted'),
      grid: {stroke: () => color('grid'), width: 1},
      ticks: {stroke: () => color('grid'), width: 1, size: 4},
      font: '12px system-ui, sans-serif',
      gap: 3,
      values: (u, splits) => splits.map((v) => (v === null ? '' : tick(v))),
      ...more,
    };
  }

  /** A chart with its caption, for a grid of charts. */
  function cell(caption, canvas) {
    return el('figure', {class: 'cell'}, el('figcaption', {}, caption), canvas);
  }

  /** Draws a shape in the units of the chart, below or above the curves. */
  function paint(u, tone, shape) {
    const {ctx, bbox} = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.strokeStyle = ctx.fillStyle = color(tone);
    ctx.lineWidth = devicePixelRatio;
    shape(ctx, (x) => u.valToPos(x, 'x', true), (y) => u.valToPos(y, 'y', true), bbox);
    ctx.restore();
  }

  function add(host, caption, options, values) {
    const canvas = el('div', {class: 'plot-canvas'});
    host.append(cell(caption, canvas));
    const u = new uPlot({
      width: Math.max(canvas.clientWidth, 160),
      height: kHeight,
      legend: {show: false},
      cursor: {show: false},
      padding: [8, 10, 0, 0],
      ...options,
      hooks: {...options.hooks, draw: [...(options.hooks?.draw ?? []), (chart) => drawn.add(chart)]},
    }, values, canvas);
    all.push({u, canvas});
    observer.observe(canvas);
  }

  /** Autocorrelations at lags 1, 2, …: bars after, circles before, and the band of white noise. */
  function correlation(host, caption, {band, before, after}) {
    const largest = Math.max(2 * band, ...after.map((v) => Math.abs(v ?? 0)),
                             ...before.map((v) => Math.abs(v ?? 0)));
    const most = Math.min(1, Math.ceil(largest * 11) / 10);
    const lags = after.map((_, i) => i + 1);
    add(host, caption, {
      scales: {x: {time: false, range: [0, lags.length + 1]}, y: {range: [-1.06 * most, 1.06 * most]}},
      axes: [axis({size: 24, space: 30, incrs: [1, 2, 5, 10, 20, 50, 100], grid: {show: false}}), axis({size: 46, space: 24})],
      hooks: {
        drawAxes: [(u) => paint(u, 'muted', (ctx, x, y, bbox) => {
          ctx.globalAlpha = 0.2;
          ctx.fillRect(bbox.left, y(band), bbox.width, y(-band) - y(band));
        })],
        draw: [(u) => {
          paint(u, 'series-1', (ctx, x, y) => {
            ctx.lineWidth = Math.max(2, 0.45 * (x(2) - x(1)));
            after.forEach((v, i) => {
              if (v === null) return;
              ctx.beginPath();
              ctx.moveTo(x(i + 1), y(0));
              ctx.lineTo(x(i + 1), y(v));
              ctx.stroke();
            });
          });
          paint(u, 'ink', (ctx, x, y) => {
            before.forEach((v, i) => {
              if (v === null) return;
              ctx.beginPath();
              ctx.arc(x(i + 1), y(v), 2.5 * devicePixelRatio, 0, 2 * Math.PI);
              ctx.stroke();
            });
          });
        }],
      },
      series: [{}, {stroke: 'transparent', points: {show: false}, paths: () => null}],
    }, [lags, after]);
  }

  /**
   * The log-likelihood over one parameter, maximized over the others, relative to its maximum; with
   * the level of the 95 % interval, the interval, the estimate and the value before.
   */
  function profile(host, caption, {x, y, value, low, high, before, level, logarithmic}) {
    // Within about a decade, a logarithmic axis would have hardly any labels.
    const wide = logarithmic && x[x.length - 1] > 30 * x[0];
    const floor = Math.max(Math.min(...y.filter((v) => v !== null), -2 * level), -6 * level);
    add(host, caption, {
      scales: {x: {time: false, distr: wide ? 3 : 1, log: 10,
                   range: () => [x[0], x[x.length - 1]]},
               y: {range: [floor, -0.08 * floor]}},
      axes: [axis({size: 24, space: 50}), axis({size: 46, space: 24})],
      hooks: {
        drawAxes: [(u) => {
          paint(u, 'series-1', (ctx, at, y_, bbox) => {
            const left = low === null ? bbox.left : Math.max(at(low || x[0]), bbox.left);
            const right = high === null ? bbox.left + bbox.width : at(high);
            ctx.globalAlpha = 0.13;
            ctx.fillRect(left, bbox.top, right - left, bbox.height);
          });
          paint(u, 'muted', (ctx, at, y_, bbox) => {
            ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
            ctx.beginPath();
            ctx.moveTo(bbox.left, y_(-level));
            ctx.lineTo(bbox.left + bbox.width, y_(-level));
            ctx.stroke();
          });
        }],
        draw: [(u) => {
          const line = (tone, at, dash) => paint(u, tone, (ctx, x_, y_, bbox) => {
            if (at === null || (logarithmic && !(at > 0))) return;
            ctx.setLineDash(dash.map((d) => d * devicePixelRatio));
            ctx.beginPath();
            ctx.moveTo(x_(at), bbox.top);
            ctx.lineTo(x_(at), bbox.top + bbox.height);
            ctx.stroke();
          });
          line('series-1', value, []);
          line('ink', before, [7, 5]);
        }],
      },
      series: [{}, {stroke: () => color('series-1'), width: 1.75, points: {show: false}}],
    }, [x, y]);
  }

  /** Shares of flights below a value, one curve for each design, and the limit. */
  function distribution(host, caption, {curves, limit}) {
    const ends = curves.flatMap(({x}) => [x[0], x[x.length - 1]]).filter((v) => v !== null);
    if (limit !== null) ends.push(limit);
    const least = Math.min(...ends), most = Math.max(...ends);
    // A design that is far worse would compress the others at the edge; see profile().
    const wide = least > 0 && most > 30 * least;
    const margin = 0.04 * (most - least || Math.abs(most) || 1);
    // Rounded outward to one digit, so that a logarithmic axis starts with a labelled number.
    const digit = (v, round) => {
      const decade = 10 ** Math.floor(Math.log10(v));
      return round(v / decade) * decade;
    };
    const range = wide ? [digit(least, Math.floor), digit(most, Math.ceil)] : [least - margin, most + margin];
    // One axis for all curves: the shares of each curve at the values of all.
    const xs = [...new Set(curves.flatMap(({x}) => x.filter((v) => v !== null)))].sort((a, b) => a - b);
    const shares = curves.map(({x, reached}) => {
      const share = new Map(x.map((v, i) => [v, 100 * reached * i / (x.length - 1)]));
      return xs.map((v) => share.get(v) ?? null);
    });
    add(host, caption, {
      scales: {x: {time: false, distr: wide ? 3 : 1, log: 10, range: () => range}, y: {range: [0, 100]}},
      axes: [axis({size: 24, space: 50}), axis({size: 46, space: 24, incrs: [10, 20, 25, 50, 100]})],
      hooks: {
        draw: [(u) => {
          if (limit === null) return;
          paint(u, 'ink', (ctx, x, y, bbox) => {
            ctx.setLineDash([7 * devicePixelRatio, 5 * devicePixelRatio]);
            ctx.beginPath();
            ctx.moveTo(x(limit), bbox.top);
            ctx.lineTo(x(limit), bbox.top + bbox.height);
            ctx.stroke();
          });
        }],
      },
      series: [{}, ...curves.map(({tone}) => ({stroke: () => color(`series-${tone}`), width: 1.75,
                                               points: {show: false}, spanGaps: true}))],
    }, [xs, ...shares]);
  }

  /** The minimum cost so far over the evaluations of a search (steps), and the evaluated points (dots). */
  function search(host, caption, {evaluation, best, tried}) {
    // A flight that diverges costs a hundred times as much; the axis shows competitive points.
    const least = Math.min(...best.filter((v) => v !== null));
    const most = Math.max(...best.filter((v) => v !== null));
    const margin = 0.1 * Math.max(most - least, 0.02 * Math.abs(most)) || 1;
    const wide = least > 0 && most > 20 * least;  // the start diverges
    const last = evaluation[evaluation.length - 1];
    add(host, caption, {
      scales: {x: {time: false, range: [0, Math.max(last, 2)]},
               y: wide ? {distr: 3, log: 10, range: [0.8 * least, 1.5 * most]}
                       : {range: [least - 2 * margin, most + 4 * margin]}},
      axes: [axis({size: 24, space: 50, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000, 100000]}),
             axis({size: 52, space: 24})],
      series: [{},
               {stroke: () => color('muted'), paths: () => null,
                points: {show: true, size: 3, width: 0, fill: () => color('muted')}},
               {stroke: () => color('series-1'), width: 2, points: {show: false},
                paths: uPlot.paths.stepped({align: 1})}],
    }, [evaluation, tried, best]);
  }

  let printing = false;
  const observer = new ResizeObserver(() => {
    if (printing) return;
    for (const {u, canvas} of all) {
      const width = Math.floor(canvas.clientWidth);
      if (width > 0 && width !== u.width) u.setSize({width, height: kHeight});
    }
  });

  return {
    correlation,
    profile,
    distribution,
    search,
    count: () => drawn.size,
    restyle: () => { for (const {u} of all) u.redraw(false, true); },
    print(on) {
      printing = on;
      for (const {u, canvas} of all)
        u.setSize(on ? kPrintSize : {width: Math.max(canvas.clientWidth, 160), height: kHeight});
    },
  };
})();
