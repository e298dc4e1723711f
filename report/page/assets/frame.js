// SPDX-License-Identifier: Apache-2.0
// The parts that all reports share: data, verdict, origin, light and dark theme, printing. The first
// error that is thrown is stored in data-error of the root element.
'use strict';

const Frame = (() => {
  const {el} = Page;
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

  /** The verdict; `counts` is a sentence before its reasons, or null. */
  function verdict(words, counts) {
    return el('div', {class: `verdict ${data.verdict}`},
              el('strong', {}, words[data.verdict]),
              el('div', {},
                 counts ? el('p', {class: 'counts'}, counts) : null,
                 data.reasons.map((reason) => el('p', {}, isolated(reason)))));
  }

  function header(kicker, title, ...children) {
    return el('header', {},
              el('div', {class: 'kicker'}, el('span', {}, kicker), themeButton),
              el('h1', {}, isolated(title)), children);
  }

  /** A section with pairs of term and description; null if there are none. */
  function about(title, given) {
    const pairs = [...given];
    if (data.seed && !pairs.some(([key]) => key.toLowerCase() === 'seed')) pairs.push(['seed', data.seed]);
    if (!pairs.length) return null;
    return section('about', title,
      el('dl', {}, pairs.map(([key, value]) => [el('dt', {}, isolated(key)), el('dd', {}, isolated(value))])));
  }

  /** The plots over time in a section of `place`, with a button that resets the zoom; or null. */
  function plots(place, clock, title, hint, whole) {
    if (!data.plots.length) return null;
    const reset = el('button', {type: 'button', class: 'reset', disabled: true}, whole);
    const host = section('plots', title, el('div', {class: 'hint'}, hint, reset));
    place.append(host);
    const drawing = Plots.draw(data, clock, host);
    drawn.push(drawing);
    drawing.zoomed((zoomed) => { reset.disabled = !zoomed; });
    reset.addEventListener('click', () => {
      drawing.reset();
      clock.set(clock.time);
    });
    return drawing;
  }

  /** @param libraries  names of the libraries in the file. */
  function origin(libraries) {
    const sentence = data.rows > data.kept
      ? `Plots show ${data.kept} of ${data.rows} rows: minimum and maximum of each interval.`
      : data.kept ? `Plots show all ${data.rows} rows.` : null;
    return el('footer', {},
      data.command ? el('p', {}, 'Produced by ', el('code', {}, isolated(data.command))) : null,
      el('p', {}, [data.version ? `quadtune ${data.version}.` : 'quadtune.',
                   data.seed ? `Seed ${data.seed}.` : null, sentence,
                   `This file loads nothing. It contains ${libraries} under the MIT licence.`]
                  .filter((s) => s !== null).join(' ')));
  }

  // --- light and dark ---

  const prefersDark = matchMedia('(prefers-color-scheme: dark)');
  let theme = prefersDark.matches ? 'dark' : 'light';
  const drawn = [];  // objects that draw colours themselves: restyle(), print(on)
  const themeButton = el('button', {type: 'button', class: 'theme'});
  function paint(name) {
    root.dataset.theme = name;
    const other = name === 'dark' ? 'light' : 'dark';
    themeButton.textContent = other === 'dark' ? 'Dark' : 'Light';
    themeButton.setAttribute('aria-label', `Change to ${other} colours`);
    for (const part of drawn) part.restyle();
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

  // Printing uses the light theme.
  window.addEventListener('beforeprint', () => {
    paint('light');
    for (const part of drawn) part.print(true);
  });
  window.addEventListener('afterprint', () => {
    for (const part of drawn) part.print(false);
    paint(theme);
  });

  return {root, data, main, section, isolated, verdict, header, about, plots, origin,
          add: (part) => drawn.push(part)};
})();
