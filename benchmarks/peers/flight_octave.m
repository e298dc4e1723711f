% SPDX-License-Identifier: Apache-2.0
% The flight of flight_benchmark.cpp by Octave's ode45. Reads a vehicle and a flight as JSON from
% the file named on the command line, writes one line: seconds, steps, evaluations (not counted:
% NaN), then the last state.
1;

function [thrust, torque, h, rises] = loads(f, w)
  t = (f.a2 .* w + f.a1) .* w;
  thrust = sum(t);
  h = sum(f.momentum .* w);
  torque = [-sum(f.y .* t); sum(f.x .* t); -sum(f.spin .* (f.d2 .* w + f.d1) .* w)];
  rises = [];
  if f.lagging
    rises = (f.speeds - w) ./ f.lag;
    torque(3) -= sum(f.momentum .* rises);
  end
end

function d = motion(x, f)
  if f.lagging
    [thrust, torque, h, rises] = loads(f, x(14:end));
  else
    thrust = f.held_thrust; torque = f.held_torque; h = f.held_h; rises = [];
  end
  q = x(4:7); v = x(8:10); w = x(11:13);
  R = [1 - 2 * (q(3)^2 + q(4)^2), 2 * (q(2) * q(3) - q(1) * q(4)), 2 * (q(2) * q(4) + q(1) * q(3));
       2 * (q(2) * q(3) + q(1) * q(4)), 1 - 2 * (q(2)^2 + q(4)^2), 2 * (q(3) * q(4) - q(1) * q(2));
       2 * (q(2) * q(4) - q(1) * q(3)), 2 * (q(3) * q(4) + q(1) * q(2)), 1 - 2 * (q(2)^2 + q(3)^2)];
  W = [0, -w(3), w(2); w(3), 0, -w(1); -w(2), w(1), 0];
  L = f.inertia .* w + [0; 0; h];
  d = [R * v;
       0.5 * [-q(2:4)' * w; q(1) * w - W * q(2:4)];
       [0; 0; -thrust / f.mass] + f.gravity * R(3, :)' - W * v;
       (torque - W * L) ./ f.inertia;
       rises];
end

f = jsondecode(fileread(argv(){1}));
f.momentum = f.spin .* f.rotor_inertia;
[f.held_thrust, f.held_torque, f.held_h] = loads(f, f.speeds);
options = odeset("RelTol", f.tolerance, "AbsTol", f.tolerance, "MaxStep", f.max_step, "Refine", 1);
% The least of several times, as for quadtune.
seconds = Inf;
for i = 1:3
  tic;
  [t, x] = ode45(@(t, x) motion(x, f), [0, f.duration], f.start, options);
  seconds = min(seconds, toc);
end
printf("%.17g ", seconds, numel(t) - 1, NaN, x(end, :));
printf("\n");
