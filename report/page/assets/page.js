// SPDX-License-Identifier: Apache-2.0
// Shared by all parts of the report: elements, numbers, colours, the clock.
'use strict';

const Page = (() => {
  /** Creates an element. Text is inserted as text, never as markup; null children are skipped. */
  function el(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (value === null || value === undefined || value === false) continue;
      if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
      else element.setAttribute(name, value === true ? '' : String(value));
    }
    for (const child of children.flat(Infinity))
      if (child !== null && child !== undefined) element.append(child);
    return element;
  }

  function bytes(base64) {
    return Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;
  }
  const float32 = (base64) => new Float32Array(bytes(base64));
  const float64 = (base64) => new Float64Array(bytes(base64));

  /** The last index whose time does not exceed t; times increase. */
  function indexAt(times, t) {
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Formats a number, with a typographic minus sign. */
  function number(value, digits = 4) {
    if (value === null || value === undefined || Number.isNaN(value)) return '\u2013';
    if (value === 0) return '0';
    const size = Math.abs(value);
    let text = value.toPrecision(digits);
    if (size >= 1e-3 && size < 1e6 && text.includes('e')) text = String(Number(text));
    if (text.includes('.') && !text.includes('e')) text = text.replace(/\.?0+$/, '');
    return text.replace(/^-/, '\u2212');
  }

  /** Formats with a fixed number of decimals, so that a changing number does not move. */
  function fixed(value, decimals) {
    if (!Number.isFinite(value)) return '\u2013';
    const text = value.toFixed(decimals);
    return (Number(text) === 0 ? (0).toFixed(decimals) : text).replace(/^-/, '\u2212');
  }

  /** Formats a number at an axis. */
  function tick(value) {
    const size = Math.abs(value);
    const text = size > 0 && (size < 1e-4 || size >= 1e6) ? value.toExponential() : String(value);
    return text.replace('e+', 'e').replace(/-/g, '\u2212');
  }

  const withUnit = (text, unit) => (unit ? `${text}\u00a0${unit}` : text);

  /** A colour of the style sheet, by the name of its CSS variable. */
  function color(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  }

  /** The time that replay, scrub bar and plots share. Listeners are called whenever it is set. */
  function makeClock(first, last) {
    const listeners = [];
    let before = 0;
    const clock = {
      first,
      last,
      time: first,
      speed: 1,
      playing: false,
      listen: (listener) => listeners.push(listener),
      set(time) {
        if (!Number.isFinite(time)) return;
        clock.time = Math.min(Math.max(time, first), last);
        for (const listener of listeners) listener(clock.time);
      },
      play() {
        if (clock.playing || !(last > first)) return;
        if (clock.time >= last) clock.time = first;
        clock.playing = true;
        before = performance.now();
        requestAnimationFrame(tick);
        clock.set(clock.time);
      },
      pause() {
        clock.playing = false;
        clock.set(clock.time);
      },
    };
    function tick() {
      if (!clock.playing) return;
      const now = performance.now();
      // A suspension of the page advances the replay by at most 250 ms.
      const seconds = Math.min(Math.max(now - before, 0), 250) / 1000;
      before = now;
      const time = clock.time + clock.speed * seconds;
      if (time >= last) clock.playing = false;
      clock.set(time);
      if (clock.playing) requestAnimationFrame(tick);
    }
    return clock;
  }

  return {el, float32, float64, indexAt, number, fixed, tick, withUnit, color, makeClock};
})();
