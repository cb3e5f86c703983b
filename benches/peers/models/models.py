"""The models that come with the program (`deltazero model list`), for tools in Python: those that switch or hit what is rigid.

A model is written once: its functions take numbers, arrays or heyoka's expressions, with the functions of that kind as `f`.
Guards are positive inside a mode; an instant that is known beforehand is no guard but an end of the mode, as a user of
these tools would do it. What a mode remembers is `data`, a number or nothing. Parameters are those of text/models.
"""

import math


class Model:
    """What most have."""

    # Whether implicit methods are tried in place of explicit ones; none: both.
    stiff = False
    # A guard counts as passed this far below zero, so that a mode may begin on its own surface.
    shift = 0.0
    # The longest step that loses no event where only the ends of a step are looked at, of modes that need one [s].
    longest_step = {}
    # Whether modes end at times that are known, and whether equations take what a mode remembers.
    timed = keeps = False

    def parts(self):
        """Models that share no term."""
        return [self]

    def guards(self, mode, t, y, data, f):
        return []

    def until(self, mode, data):
        """The time at which a mode ends [s], where it is known."""
        return None

    def at_once(self, mode, y):
        """The guard by which a mode is left where it is entered, if it is."""
        return None


class VanDerPol(Model):
    name, t_end, start, mode, modes = "van_der_pol", 2000.0, [2.0, 0.0], "smooth", ["smooth"]
    scale, stiff = [2.0, 1e-3], True

    def rates(self, mode, t, y, data, f):
        return [y[1], 1000.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]]


class IntegrateAndFire(Model):
    name, t_end, start, mode, modes = "integrate_and_fire", 0.5, [-0.070], "charging", ["charging", "refractory"]
    scale, stiff, timed = [0.026], False, True

    def rates(self, mode, t, y, data, f):
        return [(-0.070 - y[0] + 1e8 * 2e-10) / 0.01] if mode == "charging" else [0.0 * y[0]]

    def guards(self, mode, t, y, data, f):
        return [-0.054 - y[0]] if mode == "charging" else []

    def until(self, mode, data):
        return data + 0.002 if mode == "refractory" else None

    def jump(self, mode, guard, t, y, data):
        return ("refractory", [-0.080], t) if mode == "charging" else ("charging", y, data)


class BuckConverter(Model):
    name, t_end, start, mode, modes = "buck_converter", 4e-3, [0.0, 0.0], "on", ["on", "diode", "idle"]
    scale, stiff, timed = [24.0 * 1e-5 / 2e-5, 24.0], False, True
    L, C, R, T, V = 2e-5, 1e-4, 20.0, 1e-5, 24.0

    def rates(self, mode, t, y, data, f):
        i, v = y[0], y[1]
        slope = {"on": (self.V - v) / self.L, "diode": -v / self.L, "idle": 0.0 * i}[mode]
        return [slope, (i - v / self.R) / self.C]

    def guards(self, mode, t, y, data, f):
        return [y[0]] if mode == "diode" else []

    def until(self, mode, data):
        k = data or 0
        return (k + 0.4) * self.T if mode == "on" else (k + 1) * self.T

    def jump(self, mode, guard, t, y, data):
        k = data or 0
        if mode == "on":
            return "diode", y, k
        if guard is not None:
            return "idle", [0.0, y[1]], k
        return "on", y, k + 1


class Thermostat(Model):
    name, t_end, start, mode, modes = "thermostat", 2e4, [290.0], "on", ["on", "off"]
    scale, stiff = [2.0], False

    def rates(self, mode, t, y, data, f):
        loss = 200.0 * (y[0] - 275.0)
        return [((6e3 if mode == "on" else 0.0) - loss) / 2e6]

    def guards(self, mode, t, y, data, f):
        return [294.0 - y[0] if mode == "on" else y[0] - 292.0]

    def jump(self, mode, guard, t, y, data):
        return ("off" if mode == "on" else "on"), y, data


class BouncingBall(Model):
    name, t_end, start, mode, modes = "bouncing_ball", 5.0, [1.0, 0.0], "flight", ["flight", "rest"]
    scale, stiff, shift = [1.0, math.sqrt(2.0 * 9.81)], False, 1e-20

    def rates(self, mode, t, y, data, f):
        return [y[1], -9.81 + 0.0 * y[1]] if mode == "flight" else [0.0 * y[0], 0.0 * y[1]]

    def guards(self, mode, t, y, data, f):
        return [y[0]] if mode == "flight" else []

    def jump(self, mode, guard, t, y, data):
        v = -0.8 * y[1]
        # The bounces accumulate: below this speed the ball is at rest.
        return ("flight", [0.0, v], data) if v > 1e-8 * self.scale[1] else ("rest", [0.0, 0.0], data)


class ImpactOscillator(Model):
    """The spring pulls at the stop at least as much as the force pushes, so there is no rest at it."""

    name, t_end, start, mode, modes = "impact_oscillator", 21.0, [-0.1, 0.0], "free", ["free"]
    scale, stiff, shift = [0.2, 2.0], False, 1e-20

    def rates(self, mode, t, y, data, f):
        return [y[1], 10.0 * f.cos(6.0 * t) - 100.0 * 0.1 - 100.0 * y[0] - y[1]]

    def guards(self, mode, t, y, data, f):
        return [-y[0]]

    def jump(self, mode, guard, t, y, data):
        return mode, [0.0, -0.6 * y[1]], data


class RockingBlock(Model):
    name, t_end, start, mode, modes = "rocking_block", 10.0, [0.15, 0.0], "rocking", ["rocking", "rest"]
    stiff, shift, keeps = False, 1e-20, True
    alpha = math.atan2(0.2, 0.8)
    r_g = math.hypot(0.2, 0.8) / 9.81
    p2 = 0.75 / r_g
    r = 1.0 - 1.5 * math.sin(alpha) ** 2
    scale = [alpha, math.sqrt(p2) * alpha]

    def sigma(self, data):
        """1 on the right corner, where it begins, -1 on the left."""
        return 1.0 if data is None else data

    def rates(self, mode, t, y, data, f):
        if mode == "rest":
            return [0.0 * y[0], 0.0 * y[0]]
        sigma = self.sigma(data)
        return [y[1], -sigma * self.p2 * f.sin(self.alpha - sigma * y[0])]

    def guards(self, mode, t, y, data, f):
        """The tilt, what it lacks to overturn, what the corner carries."""
        if mode == "rest":
            return []
        tilt = self.sigma(data) * y[0]
        beta = self.alpha - tilt
        press = 1.0 - 0.75 * f.sin(beta) * f.sin(beta) - self.r_g * f.cos(beta) * y[1] * y[1]
        return [tilt, self.alpha + math.pi / 4.0 - tilt, press]

    def jump(self, mode, guard, t, y, data):
        if guard > 0:
            raise RuntimeError("it overturns or lifts off")
        omega = self.r * y[1]
        # The impacts accumulate: below this speed the block is at rest.
        if abs(omega) < 1e-8 * self.scale[1]:
            return "rest", [0.0, 0.0], data
        return "rocking", [0.0, omega], -self.sigma(data)


class Carts(Model):
    name, t_end, mode, modes = "carts", 1.5, "rolling", ["rolling"]
    stiff, shift = False, 1e-16
    n, k, gap, e = 50, 40.0, 0.1, 0.9
    start = [0.0] * 50 + [math.sin(i * i) for i in range(1, 51)]
    scale = [0.1] * 50 + [1.0] * 50

    def rates(self, mode, t, y, data, f):
        n = self.n
        return f.join(y[n:], [-self.k * x for x in y[:n]] if isinstance(y, list) else -self.k * y[:n])

    def guards(self, mode, t, y, data, f):
        n = self.n
        if isinstance(y, list):
            return [self.gap - (y[i] - y[i + 1]) for i in range(n - 1)]
        return self.gap - (y[: n - 1] - y[1:n])

    def jump(self, mode, guard, t, y, data):
        y, i, n = list(y), guard, self.n
        middle = (y[i] + y[i + 1]) / 2.0
        y[i], y[i + 1] = middle + self.gap / 2.0, middle - self.gap / 2.0
        a, b = y[n + i], y[n + i + 1]
        y[n + i] = ((1.0 - self.e) * a + (1.0 + self.e) * b) / 2.0
        y[n + i + 1] = ((1.0 + self.e) * a + (1.0 - self.e) * b) / 2.0
        return mode, y, data


MODELS = [VanDerPol(), IntegrateAndFire(), BuckConverter(), Thermostat(), BouncingBall(), ImpactOscillator(), RockingBlock(), Carts()]
