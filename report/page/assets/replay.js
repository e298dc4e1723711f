// SPDX-License-Identifier: Apache-2.0
// The flight in space with three.js; without WebGL, seen from above on a flat canvas.
//
// The scene is in world axes as they are recorded: x north, y east, z down. The camera's "up" is -z,
// and the vehicle is modelled in its body axes forward, right, down. No axes are converted.
'use strict';

const Replay = (() => {
  const {el, float32, float64, indexAt, fixed, color} = Page;

  const kFrontOfBody = 1e-3;    // a rotor farther forward is a front rotor [fraction of the arm]
  const kFixedShare = 0.18;     // minimum size of the vehicle for the fixed camera [fraction of the picture]
  const kFieldOfView = 40;      // [deg]

  /** The recorded flight, and its state at any time. */
  function makeFlight(data) {
    const time = float64(data.time);
    const triple = (list) => (list ? list.map(float32) : null);
    const position = triple(data.position);
    const reference = triple(data.reference);
    const estimate = triple(data.estimate);
    const q = data.quaternion.map(float32);
    const rotors = data.rotors.map((r) => {
      const speed = r.speed ? float32(r.speed) : null;
      const top = speed ? speed.reduce((m, v) => (Math.abs(v) > m ? Math.abs(v) : m), 0) : 0;
      return {position: r.position, spin: r.spin, speed, top};
    });
    const fastest = Math.max(0, ...rotors.map((r) => r.top));

    const mix = (values, i, f) => (f === 0 ? values[i] : values[i] + (values[i + 1] - values[i]) * f);
    function at(t) {
      const i = indexAt(time, t);
      const f = i + 1 < time.length ? Math.min(Math.max((t - time[i]) / (time[i + 1] - time[i]), 0), 1) : 0;
      // Rows are about 1/30 s apart, so linear interpolation of the quaternions is accurate enough.
      const a = q.map((c) => c[i]);
      let quaternion = a;
      if (f > 0) {
        const b = q.map((c) => c[i + 1]);
        const sign = a.reduce((sum, v, k) => sum + v * b[k], 0) < 0 ? -1 : 1;
        const mixed = a.map((v, k) => v + (sign * b[k] - v) * f);
        const norm = Math.hypot(...mixed);
        quaternion = mixed.map((v) => v / norm);
      }
      const near = (list) => (list ? list.map((c) => mix(c, i, f)) : null);
      const j = Math.min(i, time.length - 2);
      const dt = j >= 0 ? time[j + 1] - time[j] : 0;
      const speed = dt > 0 ? Math.hypot(...position.map((c) => (c[j + 1] - c[j]) / dt)) : NaN;
      return {
        row: i,
        position: near(position),
        reference: near(reference),
        estimate: near(estimate),
        quaternion,
        speed,
        rotors: rotors.map((r) => (r.speed && fastest > 0 ? Math.abs(mix(r.speed, i, f)) / fastest : null)),
      };
    }
    return {time, position, reference, estimate, rotors, at};
  }

  /** Roll, pitch, yaw [rad] of a quaternion w, x, y, z. */
  function angles([w, x, y, z]) {
    return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
            Math.asin(Math.min(Math.max(2 * (w * y - z * x), -1), 1)),
            Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
  }

  const finite = (point) => point !== null && point.every(Number.isFinite);

  /** The box around the flown path and the reference. */
  function bounds(flight) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const track of [flight.position, flight.reference])
      for (let axis = 0; track && axis < 3; ++axis)
        for (const v of track[axis]) {
          if (!Number.isFinite(v)) continue;
          low[axis] = Math.min(low[axis], v);
          high[axis] = Math.max(high[axis], v);
        }
    if (low.every(Number.isFinite) === false) return {low: [0, 0, 0], high: [0, 0, 0], radius: 1};
    const radius = Math.hypot(...high.map((h, i) => h - low[i])) / 2;
    return {low, high, radius};
  }

  /** A round number, a multiple of a power of ten, of at least x. */
  function roundUp(x, multiples) {
    const power = 10 ** Math.floor(Math.log10(x));
    return [...multiples, 10].map((m) => m * power).find((v) => v >= x * (1 - 1e-9));
  }
  const roundDistance = (x) => roundUp(x, [1, 2, 5]);
  const roundScale = (x) => Math.max(1, roundUp(x, [1, 2, 3, 5]));

  /** The readings above the picture: position and attitude of the vehicle. */
  function makeReadings(flight, host) {
    const cells = {};
    const item = (key, label, unit) => {
      cells[key] = el('span', {class: 'value'});
      return el('div', {}, el('span', {class: 'label'}, label), cells[key],
                el('span', {class: 'label'}, unit));
    };
    host.append(
      el('div', {class: 'readings'},
         item('north', 'north', 'm'), item('east', 'east', 'm'), item('up', 'up', 'm'),
         item('speed', 'speed', 'm/s'), item('roll', 'roll', '\u00b0'), item('pitch', 'pitch', '\u00b0'),
         item('yaw', 'yaw', '\u00b0'), flight.reference ? item('off', 'from reference', 'm') : null));
    return (state) => {
      const [roll, pitch, yaw] = angles(state.quaternion).map((a) => (a * 180) / Math.PI);
      const [n, e, d] = state.position;
      cells.north.textContent = fixed(n, 2);
      cells.east.textContent = fixed(e, 2);
      cells.up.textContent = fixed(-d, 2);
      cells.speed.textContent = fixed(state.speed, 2);
      cells.roll.textContent = fixed(roll, 1);
      cells.pitch.textContent = fixed(pitch, 1);
      cells.yaw.textContent = fixed(yaw, 1);
      if (state.reference)
        cells.off.textContent =
          fixed(Math.hypot(...state.position.map((v, i) => v - state.reference[i])), 2);
    };
  }

  /** The dimensions of the drawn vehicle, from its rotors. */
  function frame(data) {
    const places = data.rotors.map((r) => r.position);
    const arm = data.arm > 0 ? data.arm : Math.max(0.1, ...places.map((p) => Math.hypot(p[0], p[1])));
    let apart = 2 * arm;
    places.forEach((p, i) => places.slice(i + 1).forEach((other) => {
      const distance = Math.hypot(p[0] - other[0], p[1] - other[1]);
      if (distance > 0) apart = Math.min(apart, distance);
    }));
    const radius = data.rotor_radius > 0 ? data.rotor_radius : Math.min(0.46 * apart, 0.62 * arm);
    return {arm, radius, span: 2 * (arm + radius)};
  }

  // --- in space ---

  function makeRenderer() {
    // Without WebGL this throws an exception and writes to the console.
    try {
      return new Three.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
    } catch (error) {
      return null;
    }
  }

  function drawSpace(renderer, data, flight, clock, stage) {
    const scene = new Three.Scene();
    const {low, high, radius} = bounds(flight);
    const {arm, radius: rotorRadius, span} = frame(data);
    const extent = Math.max(radius, span);
    const center = new Three.Vector3(...low.map((v, i) => (v + high[i]) / 2));
    const camera = new Three.PerspectiveCamera(kFieldOfView, 1, extent / 500, extent * 200);
    camera.up.set(0, 0, -1);
    const materials = [];  // with the names of their colours, to change the theme
    const painted = (material, tone) => {
      materials.push({material, tone});
      return material;
    };

    // The ground: a square grid with a round spacing.
    const wide = Math.max(high[0] - low[0], high[1] - low[1], 4 * span, extent);
    const cell = roundDistance(wide / 12);
    const edge = [0, 1].map((axis) => [Math.floor(low[axis] / cell - 1) * cell,
                                       Math.ceil(high[axis] / cell + 1) * cell]);
    for (const axis of [0, 1]) {
      const lack = wide + 2 * cell - (edge[axis][1] - edge[axis][0]);
      const more = Math.max(0, Math.floor(lack / 2 / cell)) * cell;
      edge[axis] = [edge[axis][0] - more, edge[axis][1] + more];
    }
    const [[north0, north1], [east0, east1]] = edge;
    const lines = [];
    for (let x = north0; x <= north1 + cell / 2; x += cell) lines.push(x, east0, 0, x, east1, 0);
    for (let y = east0; y <= east1 + cell / 2; y += cell) lines.push(north0, y, 0, north1, y, 0);
    const segments = (points, material) => {
      const geometry = new Three.BufferGeometry();
      geometry.setAttribute('position', new Three.BufferAttribute(new Float32Array(points), 3));
      const object = new Three.LineSegments(geometry, material);
      object.frustumCulled = false;
      scene.add(object);
      return object;
    };
    const ground = segments(lines, painted(new Three.LineBasicMaterial(), 'ground'));
    // A finer grid follows the vehicle when the camera does.
    const kNear = 15;
    const nearLines = [];
    for (let k = -kNear; k <= kNear; ++k)
      nearLines.push(k, -kNear, 0, k, kNear, 0, -kNear, k, 0, kNear, k, 0);
    const nearGround = segments(nearLines, painted(new Three.LineBasicMaterial(), 'ground'));

    // Paths: segments between rows with values, and the row at which each segment ends.
    const pixels = [];
    const dashes = [];
    function track(rows, tone, width, {opacity = 1, dashed = false} = {}) {
      const points = [];
      const ends = [];
      for (let i = 1; i < flight.time.length; ++i) {
        const piece = [i - 1, i].flatMap((k) => rows.map((axis) => axis[k]));
        if (!piece.every(Number.isFinite)) continue;
        points.push(...piece);
        ends.push(i);
      }
      if (!ends.length) return {ends, object: null};
      const geometry = new Three.LineSegmentsGeometry();
      geometry.setPositions(points);
      const material = painted(
        new Three.LineMaterial({linewidth: width, transparent: opacity < 1, opacity, dashed}), tone);
      pixels.push(material);
      if (dashed) dashes.push(material);
      const object = new Three.LineSegments2(geometry, material);
      if (dashed) object.computeLineDistances();
      object.frustumCulled = false;
      scene.add(object);
      return {ends, object};
    }
    if (flight.reference) track(flight.reference, 'path-reference', 1.5, {dashed: true});
    if (flight.estimate) track(flight.estimate, 'path-estimate', 1, {opacity: 0.7});
    track(flight.position, 'path', 2, {opacity: 0.28});
    const past = track(flight.position, 'path', 2.75);
    if (past.object) past.object.renderOrder = 1;  // above other objects at the same place

    // The vehicle in body axes.
    const vehicle = new Three.Group();
    scene.add(vehicle);
    const lit = (tone) => painted(new Three.MeshLambertMaterial(), tone);
    const flat = (tone, opacity) =>
      painted(new Three.MeshBasicMaterial({side: Three.DoubleSide, transparent: opacity < 1, opacity,
                                           depthWrite: opacity >= 1}), tone);
    const rod = (from, to, thickness, material) => {
      const a = new Three.Vector3(...from);
      const b = new Three.Vector3(...to);
      const along = b.clone().sub(a);
      const mesh = new Three.Mesh(
        new Three.CylinderGeometry(thickness, thickness, along.length(), 10), material);
      mesh.position.copy(a).addScaledVector(along, 0.5);
      mesh.quaternion.setFromUnitVectors(new Three.Vector3(0, 1, 0), along.normalize());
      vehicle.add(mesh);
    };
    const body = new Three.Mesh(
      new Three.CylinderGeometry(0.24 * arm, 0.28 * arm, 0.16 * arm, 24), lit('body'));
    body.rotation.x = -Math.PI / 2;  // the cylinder's axis to body z, its narrow end up
    vehicle.add(body);
    rod([0.2 * arm, 0, 0], [0.5 * arm, 0, 0], 0.05 * arm, lit('front'));  // the nose
    const rotors = flight.rotors.map((rotor) => {
      const [x, y, z] = rotor.position;
      const side = Math.abs(x) < kFrontOfBody * arm ? 'side' : x > 0 ? 'front' : 'back';
      if (Math.hypot(x, y, z) > 0) rod([0, 0, 0], [x, y, z], 0.045 * arm, lit('body'));
      const hub = new Three.Group();
      hub.position.set(x, y, z - 0.08 * arm);
      vehicle.add(hub);
      hub.add(new Three.Mesh(new Three.RingGeometry(0.93 * rotorRadius, rotorRadius, 48), flat(side, 1)));
      hub.add(new Three.Mesh(new Three.CircleGeometry(0.93 * rotorRadius, 48), flat(side, 0.22)));
      const disc = new Three.Mesh(new Three.CircleGeometry(0.93 * rotorRadius, 48), flat(side, 0.5));
      disc.position.z = -0.005 * arm;
      hub.add(disc);
      return {disc, spin: rotor.spin};
    });
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, i) => {
      rod([0, 0, 0], axis.map((v) => v * 1.25 * arm), 0.022 * arm, flat(`axis-${'xyz'[i]}`, 1));
    });
    const sky = new Three.HemisphereLight(0xffffff, 0x888888, 2.2);
    sky.position.set(0, 0, -1);
    const sun = new Three.DirectionalLight(0xffffff, 1.6);
    sun.position.set(-1, -0.6, -2);
    scene.add(sky, sun);

    // Its position above the ground.
    const drop = segments([0, 0, 0, 0, 0, 0], painted(new Three.LineBasicMaterial(), 'muted'));
    const spot = new Three.Mesh(new Three.RingGeometry(0.75, 1, 40), flat('muted', 0.8));
    scene.add(spot);
    const target = new Three.Mesh(new Three.SphereGeometry(1, 20, 14), flat('path-reference', 1));
    scene.add(target);

    const canvas = renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'The flight in space: drag to turn, space to play');
    stage.append(canvas);
    const marks = [['N', north1, (east0 + east1) / 2], ['E', (north0 + north1) / 2, east1]]
      .map(([text, n, e]) => {
        const label = el('span', {class: 'mark'}, text);
        stage.append(label);
        return {label, point: new Three.Vector3(n, e, 0)};
      });

    const controls = new Three.OrbitControls(camera, canvas);
    controls.enableDamping = false;
    controls.maxDistance = extent * 60;
    controls.minDistance = span * 0.8;
    // The wheel scrolls the page until the picture was clicked, as do vertical touch gestures.
    canvas.addEventListener('wheel', (event) => {
      controls.enableZoom = event.ctrlKey || document.activeElement === canvas;
    }, {capture: true, passive: true});
    canvas.style.touchAction = 'pan-y';
    canvas.addEventListener('keydown', (event) => {
      if (event.key !== ' ') return;
      event.preventDefault();
      if (clock.playing) clock.pause();
      else clock.play();
    });

    const view = {following: false, scale: 1, cell};
    let last = null;

    function home() {
      const direction = view.following ? new Three.Vector3(-1, -0.35, -0.5)
                                       : new Three.Vector3(-0.85, -0.5, -0.62);
      const half = (kFieldOfView / 2) * (Math.PI / 180);
      const narrow = Math.min(1, camera.aspect);
      const size = view.following ? span * 1.3 : Math.max(radius, span) * 1.08;
      const distance = size / Math.sin(Math.atan(Math.tan(half) * narrow));
      controls.target.copy(view.following && last ? last : center);
      camera.position.copy(controls.target).addScaledVector(direction.normalize(), distance);
      camera.updateProjectionMatrix();
      controls.update();
    }

    let queued = false;
    function redraw() {
      if (queued) return;
      queued = true;
      requestAnimationFrame(render);
    }
    function render() {
      queued = false;
      renderer.render(scene, camera);
      const box = stage.getBoundingClientRect();
      for (const {label, point} of marks) {
        const p = point.clone().project(camera);
        const inside = p.z < 1 && Math.abs(p.x) < 0.97 && Math.abs(p.y) < 0.95;
        label.hidden = !inside;
        label.style.left = `${((p.x + 1) / 2) * box.width}px`;
        label.style.top = `${((1 - p.y) / 2) * box.height}px`;
      }
    }
    controls.addEventListener('change', redraw);

    let spun = clock.time;
    function show(state) {
      vehicle.visible = finite(state.position) && finite(state.quaternion);
      drop.visible = spot.visible = vehicle.visible;
      target.visible = finite(state.reference);
      if (vehicle.visible) {
        const [w, x, y, z] = state.quaternion;
        vehicle.position.set(...state.position);
        vehicle.quaternion.set(x, y, z, w);
        vehicle.scale.setScalar(view.scale);
        if (view.following && last) {
          const moved = vehicle.position.clone().sub(last);
          camera.position.add(moved);
          controls.target.add(moved);
          controls.update();
        }
        last = vehicle.position.clone();
        const points = drop.geometry.getAttribute('position');
        points.setXYZ(0, last.x, last.y, last.z);
        points.setXYZ(1, last.x, last.y, 0);
        points.needsUpdate = true;
        spot.position.set(last.x, last.y, 0);
        if (view.following) {
          view.cell = roundDistance(Math.max(span, Math.abs(last.z) / 4));
          nearGround.scale.setScalar(view.cell);
          nearGround.position.set(Math.round(last.x / view.cell) * view.cell,
                                  Math.round(last.y / view.cell) * view.cell, 0);
        }
        spot.scale.setScalar(0.5 * arm * view.scale);
      }
      if (target.visible) {
        target.position.set(...state.reference);
        target.scale.setScalar(view.following ? 0.07 * arm : Math.max(0.1 * arm * view.scale, extent / 140));
      }
      rotors.forEach(({disc}, i) => {
        const share = state.rotors[i];
        disc.visible = share !== null && share > 0.02;
        disc.scale.setScalar(share === null ? 1 : Math.min(Math.max(share, 0.02), 1));
      });
      if (past.object) {
        // The number of segments that have ended.
        let count = indexAt(past.ends, state.row);
        count = past.ends[count] <= state.row ? count + 1 : 0;
        past.object.visible = count > 0;
        past.object.geometry.instanceCount = count;
      }
      redraw();
    }

    function restyle() {
      for (const {material, tone} of materials) material.color.set(color(tone));
      renderer.setClearColor(color('stage'), 1);
      redraw();
    }

    function resize() {
      const width = Math.max(stage.clientWidth, 50);
      const height = Math.max(stage.clientHeight, 50);
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
      renderer.setSize(width, height, false);
      const first = camera.aspect === 1;
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      for (const material of pixels) material.resolution.set(width, height);
      if (first) home();
      redraw();
    }

    function follow(on) {
      view.following = on;
      // From far away the vehicle would be a dot.
      view.scale = on ? 1 : roundScale((kFixedShare * 2 * extent) / span);
      view.cell = cell;
      ground.visible = !on;
      nearGround.visible = on;
      for (const material of dashes) {
        material.dashSize = on ? span / 3 : extent / 45;
        material.gapSize = 0.75 * material.dashSize;
      }
      show(flight.at(clock.time));
      home();
      redraw();
    }

    restyle();
    resize();
    follow(radius > 60 * span);
    renderer.render(scene, camera);
    return {
      kind: 'drawn',
      view,
      show,
      restyle,
      resize,
      follow,
      home() { home(); redraw(); },
      zoom(factor) {
        camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
        controls.update();
        redraw();
      },
      /** A browser prints a WebGL canvas as last shown, but a plain canvas in its current state. */
      print(on) {
        stage.querySelector('.paper')?.remove();
        canvas.hidden = on;
        if (!on) return;
        render();
        const copy = el('canvas', {class: 'paper', width: canvas.width, height: canvas.height});
        copy.getContext('2d').drawImage(canvas, 0, 0);
        stage.append(copy);
      },
      render,
      /** The position of a point of the body in the picture [px], to the right and down from its corner. */
      project(point) {
        vehicle.updateWorldMatrix(true, false);
        camera.updateMatrixWorld();
        const p = vehicle.localToWorld(new Three.Vector3(...point)).project(camera);
        return [((p.x + 1) / 2) * stage.clientWidth, ((1 - p.y) / 2) * stage.clientHeight];
      },
      /** Moves the camera to a position relative to the vehicle, in world axes [m]. */
      look(offset) {
        controls.target.copy(vehicle.position);
        camera.position.copy(vehicle.position).add(new Three.Vector3(...offset));
        controls.update();
        redraw();
      },
    };
  }

  // --- from above ---

  function drawFlat(data, flight, clock, stage) {
    const canvas = el('canvas', {role: 'img', 'aria-label': 'The flight seen from above'});
    stage.append(canvas);
    const {low, high, radius} = bounds(flight);
    const {span} = frame(data);
    const extent = Math.max(radius, span);
    const cell = roundDistance((2 * extent) / 12);
    let state = flight.at(clock.time);

    function render() {
      const width = stage.clientWidth;
      const height = stage.clientHeight;
      const ratio = devicePixelRatio;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      const ctx = canvas.getContext('2d');
      ctx.scale(ratio, ratio);
      ctx.fillStyle = color('stage');
      ctx.fillRect(0, 0, width, height);
      // North is up, east to the right; both axes have the same scale.
      const north = (low[0] + high[0]) / 2;
      const east = (low[1] + high[1]) / 2;
      const size = Math.min((0.82 * width) / Math.max(high[1] - low[1], 2 * span),
                            (0.78 * height) / Math.max(high[0] - low[0], 2 * span));
      const x = (e) => width / 2 + (e - east) * size;
      const y = (n) => height / 2 - (n - north) * size;

      ctx.lineWidth = 1;
      ctx.strokeStyle = color('ground');
      ctx.fillStyle = color('muted');
      ctx.font = '11px system-ui, sans-serif';
      for (let k = Math.ceil((north - height / 2 / size) / cell); y(k * cell) > 0; ++k) {
        ctx.beginPath();
        ctx.moveTo(0, y(k * cell));
        ctx.lineTo(width, y(k * cell));
        ctx.stroke();
      }
      for (let k = Math.ceil((east - width / 2 / size) / cell); x(k * cell) < width; ++k) {
        ctx.beginPath();
        ctx.moveTo(x(k * cell), 0);
        ctx.lineTo(x(k * cell), height);
        ctx.stroke();
      }
      ctx.fillText('N \u2191', width / 2 - 8, 14);

      const path = (track, tone, lineWidth, dash, end, alpha = 1) => {
        ctx.strokeStyle = color(tone);
        ctx.lineWidth = lineWidth;
        ctx.globalAlpha = alpha;
        ctx.setLineDash(dash);
        ctx.beginPath();
        let pen = false;
        for (let i = 0; i <= end; ++i) {
          const n = track[0][i];
          const e = track[1][i];
          if (!Number.isFinite(n) || !Number.isFinite(e)) pen = false;
          else if (pen) ctx.lineTo(x(e), y(n));
          else {
            ctx.moveTo(x(e), y(n));
            pen = true;
          }
        }
        ctx.stroke();
        ctx.setLineDash([]);
        ctx.globalAlpha = 1;
      };
      const end = flight.time.length - 1;
      if (flight.reference) path(flight.reference, 'path-reference', 1.25, [6, 5], end);
      if (flight.estimate) path(flight.estimate, 'path-estimate', 1.25, [], end);
      path(flight.position, 'path', 2, [], end, 0.3);
      path(flight.position, 'path', 2.5, [], state.row);

      if (!finite(state.position) || !finite(state.quaternion)) return;
      ctx.save();
      ctx.translate(x(state.position[1]), y(state.position[0]));
      ctx.rotate(angles(state.quaternion)[2]);  // both are clockwise here
      ctx.fillStyle = color('front');
      ctx.beginPath();
      ctx.moveTo(0, -13);
      ctx.lineTo(8, 9);
      ctx.lineTo(0, 4);
      ctx.lineTo(-8, 9);
      ctx.closePath();
      ctx.fill();
      ctx.restore();
    }
    render();
    return {
      kind: 'flat',
      view: {following: false, scale: 1, cell},
      show(next) {
        state = next;
        render();
      },
      restyle: render,
      resize: render,
      print() {},
      render,
    };
  }

  /** Builds the replay into a host. */
  function draw(data, clock, host) {
    const flight = makeFlight(data.replay);
    const stage = el('div', {class: 'stage'});
    host.append(stage);
    const renderer = makeRenderer();
    const picture = renderer ? drawSpace(renderer, data.replay, flight, clock, stage)
                             : drawFlat(data.replay, flight, clock, stage);
    const read = makeReadings(flight, stage);

    const play = el('button', {type: 'button', class: 'play'});
    const scrub = el('input', {type: 'range', class: 'scrub', min: clock.first, max: clock.last,
                               step: 'any', 'aria-label': 'Time of the flight'});
    const ticks = el('div', {class: 'ticks', 'aria-hidden': 'true'});
    for (const event of data.events) {
      if (event.time === null || !(clock.last > clock.first)) continue;
      const share = (event.time - clock.first) / (clock.last - clock.first);
      if (share < 0 || share > 1) continue;
      const tick = el('i');
      tick.style.left = `${100 * share}%`;
      ticks.append(tick);
    }
    const now = el('output', {class: 'now'});
    const speed = el('select', {'aria-label': 'Speed of the replay'},
                     [0.25, 0.5, 1, 2, 4, 8].map((s) =>
                       el('option', {value: s, selected: s === 1}, `${s}\u00d7`)));
    play.addEventListener('click', () => (clock.playing ? clock.pause() : clock.play()));
    scrub.addEventListener('input', () => clock.set(Number(scrub.value)));
    speed.addEventListener('change', () => { clock.speed = Number(speed.value); });
    host.append(el('div', {class: 'transport'}, play, el('div', {class: 'bar'}, scrub, ticks), now, speed));

    const note = el('p', {class: 'note'});
    const describe = () => {
      const grid = `Grid ${picture.view.cell} m.`;
      if (picture.kind === 'flat') {
        note.textContent = `${grid} This browser has no WebGL, so the flight is shown from above.`;
        return;
      }
      const {scale} = picture.view;
      const text = grid + (scale > 1 ? ` Vehicle drawn at ${scale} times its size.` : '') +
        (flight.rotors.some((r) => r.top > 0) ? ' The fill of a rotor disc shows its speed.' : '');
      if (note.textContent !== text) note.textContent = text;
    };
    const key = (tone, text, shape = 'line') =>
      el('span', {class: 'key-item'}, el('i', {class: `${shape} tone-${tone}`}), text);
    const buttons = [];
    if (picture.kind === 'drawn') {
      const camera = [['Fixed', false], ['Follow', true]].map(([text, on]) => {
        const button = el('button', {type: 'button'}, text);
        button.addEventListener('click', () => {
          picture.follow(on);
          press();
          describe();
        });
        return {button, on};
      });
      const press = () => {
        for (const {button, on} of camera)
          button.setAttribute('aria-pressed', String(picture.view.following === on));
      };
      press();
      buttons.push(
        el('div', {class: 'group', role: 'group', 'aria-label': 'Camera'}, camera.map((c) => c.button)),
        el('div', {class: 'group', role: 'group', 'aria-label': 'Distance'},
           el('button', {type: 'button', 'aria-label': 'Nearer', onclick: () => picture.zoom(0.8)}, '+'),
           el('button', {type: 'button', 'aria-label': 'Farther', onclick: () => picture.zoom(1.25)},
              '\u2212'),
           el('button', {type: 'button', onclick: () => picture.home()}, 'Reset')));
    }
    host.append(
      el('div', {class: 'under'},
         el('div', {class: 'key-list'},
            key('path', 'flown'),
            flight.reference ? key('path-reference', 'reference') : null,
            flight.estimate ? key('path-estimate', 'estimate') : null,
            picture.kind === 'drawn' && flight.rotors.length
              ? [key('front', 'front rotors', 'disc'), key('back', 'back rotors', 'disc')] : null,
            picture.kind === 'drawn'
              ? [key('axis-x', 'x forward'), key('axis-y', 'y right'), key('axis-z', 'z down')] : null),
         el('div', {class: 'buttons'}, buttons)),
      note);
    describe();

    const whole = clock.last.toFixed(1);
    clock.listen((t) => {
      const state = flight.at(t);
      picture.show(state);
      read(state);
      describe();
      if (document.activeElement !== scrub || Number(scrub.value) !== t) scrub.value = t;
      scrub.setAttribute('aria-valuetext', `${t.toFixed(2)} seconds`);
      now.textContent = `${t.toFixed(2)} / ${whole} s`;
      play.textContent = clock.playing ? 'Pause' : 'Play';
    });
    new ResizeObserver(() => picture.resize()).observe(stage);
    return {...picture, stage, at: flight.at};
  }

  return {draw};
})();
