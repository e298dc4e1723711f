#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the calls of docs/from-matlab.md and docs/from-python-control.md: peer_calls.py PROGRAM PEER

PEER is octave, for Octave's control package, or python, for python-control. Each call is run by the
program and by the peer, which prints its numbers one after another. Exit status 77 if the peer is not
installed, 1 if a number differs.
"""
import json
import math
import shutil
import subprocess
import sys

PLANT = ['--A', '0 1; 0 -0.5', '--B', '0; 4']
WEIGHTS = ['--Q', '1 0; 0 0.1', '--R', '0.2']
NOISE = ['--A', '0 1; 0 -0.5', '--G', '0; 1', '--C', '1 0', '--Q', '0.5', '--R', '0.001']
LOOP = ['margins', '--num', '25', '--den', '1,10,10,10']

OCTAVE_START = """
pkg load control
A = [0 1; 0 -0.5]; B = [0; 4]; C = [1 0]; G = [0; 1]; Q = diag([1 0.1]); R = 0.2; Ts = 0.01;
L = tf(25, [1 10 10 10]);
% The exact sampled cost, by Van Loan's exponential.
M = [A B; zeros(1, 3)]; W = blkdiag(Q, R);
E = expm([-M' W; zeros(3) M] * Ts);
F = E(4:6, 4:6); V = F' * E(1:3, 4:6); V = (V + V') / 2;
Ad = F(1:2, 1:2); Bd = F(1:2, 3); Qd = V(1:2, 1:2); Nd = V(1:2, 3); Rd = V(3, 3);
show = @(x) printf('%.15g\\n', x);
"""
PYTHON_START = """
import control as ct, numpy as np
A = np.array([[0, 1], [0, -0.5]]); B = np.array([[0], [4]]); C = np.array([[1, 0]])
G = np.array([[0], [1]]); Q = np.diag([1, 0.1]); R = np.array([[0.2]])
L = ct.tf([25], [1, 10, 10, 10])
def show(*values):
    for value in values:
        for number in np.asarray(value, dtype=float).ravel(order='F'): print(repr(float(number)))
"""


def columns(matrix):
    """Numbers of a matrix, column by column, as the peers print them."""
    return [row[j] for j in range(len(matrix[0])) for row in matrix]


def step_at(figure, times):
    """The step response of a figure at some times, by linear interpolation."""
    curve = figure['panels'][0]['curves'][0]
    values = []
    for t in times:
        k = next(k for k in range(1, len(curve['x'])) if curve['x'][k] >= t)
        share = (t - curve['x'][k - 1]) / (curve['x'][k] - curve['x'][k - 1])
        values.append(curve['y'][k - 1] + share * (curve['y'][k] - curve['y'][k - 1]))
    return values


# name, arguments of the program, numbers of its JSON, Octave, Python ('' where the peer has no such
# call), tolerance
CALLS = [
    ('lqr', ['lqr', *PLANT, *WEIGHTS], lambda j: columns(j['K']),
     'show(lqr(A, B, Q, R))', 'show(ct.lqr(A, B, Q, R)[0])', 1e-9),
    ('dlqr', ['lqr', '--A', '1 0.1; 0 0.95', '--B', '0; 0.4', *WEIGHTS, '--discrete'],
     lambda j: columns(j['K']), 'show(dlqr([1 0.1; 0 0.95], [0; 0.4], Q, R))',
     'show(ct.dlqr(np.array([[1, 0.1], [0, 0.95]]), np.array([[0], [0.4]]), Q, R)[0])', 1e-9),
    ('lqrd', ['lqr', *PLANT, *WEIGHTS, '--sampled', '0.01'],
     lambda j: columns(j['K']) + columns(j['sampled']['Q']) + columns(j['sampled']['N']) +
     columns(j['sampled']['R']),
     'show(dlqr(Ad, Bd, Qd, Rd, Nd)); show(Qd); show(Nd); show(Rd)', '', 1e-8),
    ('lqi', ['lqr', *PLANT, '--C', '1 0', '--Q', '1 0 0; 0 0.1 0; 0 0 2', '--R', '0.2'],
     lambda j: columns(j['K']) + [j['K_int'][0][0]],
     'show(lqr([A [0; 0]; C 0], [B; 0], blkdiag(Q, 2), R))',
     'show(ct.lqr(ct.ss(A, B, C, 0), np.diag([1, 0.1, 2]), R, integral_action=C)[0])', 1e-9),
    ('delay', ['lqr', *PLANT, *WEIGHTS, '--sampled', '0.01', '--delay', '2'],
     lambda j: columns(j['K']) + columns(j['K_past']),
     'K = dlqr(Ad, Bd, Qd, Rd, Nd); show(K * Ad^2); show(K * Bd); show(K * Ad * Bd)', '', 1e-8),
    ('place', ['place', *PLANT, '--poles=-4+3i,-4-3i'], lambda j: columns(j['K']),
     'show(place(A, B, [-4+3i, -4-3i]))', 'show(ct.place(A, B, [-4+3j, -4-3j]))', 1e-9),
    ('kalman', ['kalman', *NOISE, '--continuous'], lambda j: columns(j['L']) + columns(j['P']),
     '[l, p] = lqe(A, G, C, 0.5, 0.001); show(l); show(p)',
     'l, p, e = ct.lqe(A, G, C, np.array([[0.5]]), np.array([[0.001]])); show(l, p)', 1e-8),
    ('kalmd', ['kalman', *NOISE, '--sampled', '0.01'],
     lambda j: columns(j['sampled']['Q']) + columns(j['M']),
     "H = expm([-A G*0.5*G'; zeros(2) A'] * Ts); Wd = H(3:4, 3:4)' * H(1:2, 3:4);"
     'Wd = (Wd + Wd\') / 2; show(Wd); show(dlqe(Ad, eye(2), C, Wd, 0.1))', '', 1e-8),
    ('lqg', ['lqg', *PLANT, '--C', '1 0', *WEIGHTS, '--G', '0; 1', '--noise-Q', '0.5', '--noise-R',
             '0.001', '--continuous'],
     lambda j: columns(j['controller']['A']) + columns(j['controller']['B']) +
     columns(j['controller']['C']),
     'K = lqr(A, B, Q, R); l = lqe(A, G, C, 0.5, 0.001); show(A - B*K - l*C); show(l); show(K)',
     'K = ct.lqr(A, B, Q, R)[0]; l = ct.lqe(A, G, C, np.array([[0.5]]), np.array([[0.001]]))[0]\n'
     'show(A - B @ K - l @ C, l, K)', 1e-8),
    ('c2d', ['discretize', *PLANT, '--C', '1 0', '--dt', '0.01'],
     lambda j: columns(j['A']) + columns(j['B']),
     "d = c2d(ss(A, B, C, 0), Ts, 'zoh'); show(d.a); show(d.b)",
     'd = ct.sample_system(ct.ss(A, B, C, 0), 0.01); show(d.A, d.B)', 1e-9),
    ('d2c', ['discretize', '--num', '0.02,0.02', '--den', '1,-0.9', '--dt', '0.1', '--method',
             'tustin', '--inverse'],
     lambda j: [x / j['den'][0] for x in j['num'][-2:] + j['den'][-2:]],
     "[n, d] = tfdata(d2c(tf([0.02 0.02], [1 -0.9], 0.1), 'tustin'), 'vector');"
     "n = [zeros(1, 2 - numel(n)) n]; show(n / d(1)); show(d / d(1))", '', 1e-8),
    ('margin', LOOP,
     lambda j: [j['loops'][0]['gain_margin_db'], j['loops'][0]['phase_margin_deg'],
                j['loops'][0]['phase_crossovers'][0]['w'], j['loops'][0]['crossover']],
     '[gm, pm, wg, wp] = margin(L); show(20 * log10(gm)); show(pm); show(wg); show(wp)',
     'gm, pm, wg, wp = ct.margin(L); show(20 * np.log10(gm), pm, wg, wp)', 1e-6),
    ('controller times plant', ['margins', *PLANT, '--C', '1 0', '--pid', '5,2,1.5,0.02'],
     lambda j: [j['loops'][0]['phase_margin_deg'], j['loops'][0]['crossover']],
     "s = tf('s'); [gm, pm, wg, wp] = margin((5 + 2/s + 1.5*s/(0.02*s + 1)) * 4/(s*(s + 0.5)));"
     'show(pm); show(wp)',
     's = ct.tf("s"); m = ct.margin((5 + 2/s + 1.5*s/(0.02*s + 1)) * 4/(s*(s + 0.5)));'
     'show(m[1], m[3])', 1e-5),
    ('sensitivity', LOOP, lambda j: [j['loops'][0]['Ms'], j['loops'][0]['Ms_frequency']],
     '[Ms, ws] = norm(feedback(1, L), inf, 1e-10); show(Ms); show(ws)',
     'm = ct.stability_margins(L); show(1 / m[2], m[5])', 1e-3),
    ('analyze', ['analyze', '--num', '1,2', '--den', '1,0.4,4'],
     lambda j: [j['zeros'][0][0], j['dc_gain'][0][0], j['hinf_norm'], j['h2_norm']],
     'H = tf([1 2], [1 0.4 4]); show(zero(H)); show(dcgain(H)); show(norm(H, inf, 1e-10)); show(norm(H, 2))',
     'H = ct.tf([1, 2], [1, 0.4, 4])\n'
     'show(H.zeros().real, H.dcgain(), ct.norm(H, "inf"), ct.norm(H, 2))', 1e-5),
    ('step', [*LOOP, '--plot', '/dev/stdout'], None,
     '[y, t] = step(feedback(L, 1), [0:0.5:3]); show(y(2:7))',
     'show(ct.step_response(ct.feedback(L), np.arange(0, 3.01, 0.5))[1][1:7])', 2e-3),
]


def numbers_of_program(program, arguments, read):
    """The numbers of one call of the program."""
    if read is None:  # a step response, from the curves of the picture
        import pathlib
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / 'loop.json'
            arguments = [*arguments[:-1], str(file)]
            subprocess.run([program, *arguments, '--quiet'], check=True, capture_output=True)
            return step_at(json.loads(file.read_text()), [0.5, 1, 1.5, 2, 2.5, 3])
    printed = subprocess.run([program, *arguments, '--json', '--quiet'], check=True, text=True,
                             capture_output=True).stdout
    return read(json.loads(printed))


def octave(code):
    return subprocess.run(['octave-cli', '--no-gui', '--eval', OCTAVE_START + code], text=True,
                          capture_output=True, check=False)


def python(code):
    return subprocess.run([sys.executable, '-c', PYTHON_START + code], text=True, capture_output=True,
                          check=False)


def main(args):
    program, peer = args
    run = octave if peer == 'octave' else python
    if peer == 'octave' and not shutil.which('octave-cli') or run('').returncode != 0:
        print(f'{peer} with its control package is not installed')
        return 77
    wrong = 0
    for name, arguments, read, *codes, tolerance in CALLS:
        code = codes[0 if peer == 'octave' else 1]
        if not code:
            continue
        ours = numbers_of_program(program, arguments, read)
        result = run(code)
        theirs = [float(word) for word in result.stdout.split()] if result.returncode == 0 else []
        same = len(ours) == len(theirs) and all(
            math.isfinite(a) and abs(a - b) <= tolerance * max(1, abs(b)) for a, b in zip(ours, theirs))
        print(f'{"same" if same else "DIFFERENT":10}{name}')
        if not same:
            wrong += 1
            print(f'  ours   {ours}\n  theirs {theirs}\n{result.stderr}')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
