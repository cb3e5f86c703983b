"""Five of the models that come with the program (`deltazero model list`), for tools in Python.

A model is written once: its functions take numbers, arrays or heyoka's expressions, with the functions of that kind as `f`.
Guards are positive inside a mode; an instant that is known beforehand is no guard but an end of the mode, as a user of
these tools would do it. Parameters are those of text/models.
"""

import math


class Model:
    """What most have."""

    def guards(self, mode, y):
        return []

    def until(self, mode, data):
        """The time at which a mode ends [s], where it is known."""
        return None

    def clear(self, mode, y):
        """A time in which a mode leaves its surface, short beside its length [s]; zero where it begins off it."""
        return 0.0


class VanDerPol(Model):
    name, t_end, start, mode = "van_der_pol", 2000.0, [2.0, 0.0], "smooth"
    scale, stiff = [2.0, 1e-3], True

    def rates(self, mode, y, f):
        return [y[1], 1000.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]]


class IntegrateAndFire(Model):
    name, t_end, start, mode = "integrate_and_fire", 0.5, [-0.070], "charging"
    scale, stiff = [0.026], False

    def rates(self, mode, y, f):
        return [(-0.070 - y[0] + 1e8 * 2e-10) / 0.01] if mode == "charging" else [0.0 * y[0]]

    def guards(self, mode, y):
        return [-0.054 - y[0]] if mode == "charging" else []

    def until(self, mode, data):
        return data + 0.002 if mode == "refractory" else None

    def jump(self, mode, guard, t, y, data):
        return ("refractory", [-0.080], t) if mode == "charging" else ("charging", y, data)


class BuckConverter(Model):
    name, t_end, start, mode = "buck_converter", 4e-3, [0.0, 0.0], "on"
    scale, stiff = [24.0 * 1e-5 / 2e-5, 24.0], False
    L, C, R, T, V = 2e-5, 1e-4, 20.0, 1e-5, 24.0

    def rates(self, mode, y, f):
        i, v = y[0], y[1]
        slope = {"on": (self.V - v) / self.L, "diode": -v / self.L, "idle": 0.0 * i}[mode]
        return [slope, (i - v / self.R) / self.C]

    def guards(self, mode, y):
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


class RockingBlock(Model):
    name, t_end, start, mode = "rocking_block", 10.0, [0.15, 0.0], "right"
    stiff = False
    alpha = math.atan2(0.2, 0.8)
    p2 = 3.0 * 9.81 / (4.0 * math.hypot(0.2, 0.8))
    r = 1.0 - 1.5 * math.sin(alpha) ** 2
    scale = [alpha, math.sqrt(p2) * alpha]

    def rates(self, mode, y, f):
        if mode == "rest":
            return [0.0 * y[0], 0.0 * y[0]]
        sigma = 1.0 if mode == "right" else -1.0
        return [y[1], -sigma * self.p2 * f.sin(self.alpha - sigma * y[0])]

    def guards(self, mode, y):
        return [] if mode == "rest" else [y[0] if mode == "right" else -y[0]]

    def clear(self, mode, y):
        return 2e-3 * abs(y[1]) / (self.p2 * math.sin(self.alpha))

    def jump(self, mode, guard, t, y, data):
        omega = self.r * y[1]
        # The impacts accumulate: below this speed the block is at rest.
        if abs(omega) < 1e-10 * self.scale[1]:
            return "rest", [0.0, 0.0], data
        return ("left" if mode == "right" else "right"), [0.0, omega], data


class Carts(Model):
    name, t_end, mode = "carts", 1.5, "rolling"
    stiff = False
    n, k, gap, e = 50, 40.0, 0.1, 0.9
    start = [0.0] * 50 + [math.sin(i * i) for i in range(1, 51)]
    scale = [0.1] * 50 + [1.0] * 50

    def rates(self, mode, y, f):
        n = self.n
        return f.join(y[n:], [-self.k * x for x in y[:n]] if isinstance(y, list) else -self.k * y[:n])

    def guards(self, mode, y):
        n = self.n
        if isinstance(y, list):
            return [self.gap - (y[i] - y[i + 1]) for i in range(n - 1)]
        return self.gap - (y[: n - 1] - y[1:n])

    def clear(self, mode, y):
        return 1e-9

    def jump(self, mode, guard, t, y, data):
        y, i, n = list(y), guard, self.n
        middle = (y[i] + y[i + 1]) / 2.0
        y[i], y[i + 1] = middle + self.gap / 2.0, middle - self.gap / 2.0
        a, b = y[n + i], y[n + i + 1]
        y[n + i] = ((1.0 - self.e) * a + (1.0 + self.e) * b) / 2.0
        y[n + i + 1] = ((1.0 + self.e) * a + (1.0 - self.e) * b) / 2.0
        return mode, y, data


MODELS = [VanDerPol(), IntegrateAndFire(), BuckConverter(), RockingBlock(), Carts()]
