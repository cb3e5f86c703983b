"""The models whose contact gives way or rubs, written as those of models.py."""

import copy
import math

from models import Model


class MassAgainstStop(Model):
    name, t_end, start, mode = "mass_against_stop", 0.2, [-1e-3, 0.0], "flight"
    modes, shift, longest_step = ["flight", "contact", "leaving"], 1e-16, {"leaving": 2e-5}
    K, D, g = 1e7, 0.2 * math.sqrt(1e7), 9.81
    scale, stiff = [1e-4, math.sqrt(2.0 * 9.81 * 1e-3)], False

    def push(self, y):
        return self.K * y[0] + self.D * y[1]

    def rates(self, mode, t, y, data, f):
        return [y[1], self.g - self.push(y) if mode == "contact" else self.g + 0.0 * y[1]]

    def guards(self, mode, t, y, data, f):
        return {"flight": [-y[0]], "contact": [self.push(y) / self.K], "leaving": [y[0], -self.push(y) / self.K]}[mode]

    def jump(self, mode, guard, t, y, data):
        if mode == "leaving":
            return ("flight" if guard == 0 else "contact"), y, data
        return ("contact" if mode == "flight" else "leaving"), y, data


class CamFollower(Model):
    name, t_end, mode = "cam_follower", 0.1, "contact"
    modes, shift, longest_step = ["flight", "contact", "leaving"], 1e-15, {"leaving": 3e-6}
    m, k, F_0, c, h, Omega, K, D = 0.2, 1e4, 100.0, 5.0, 0.01, 480.0, 1e8, 900.0
    start = [-(F_0 + m * h / 2.0 * Omega**2) / (K + k), 0.0]
    scale, stiff = [h, h / 2.0 * Omega], False

    def delta(self, t, y, f):
        return self.h / 2.0 * (1.0 - f.cos(self.Omega * t)) - y[0]

    def push(self, t, y, f):
        return self.K * self.delta(t, y, f) + self.D * (self.h / 2.0 * self.Omega * f.sin(self.Omega * t) - y[1])

    def rates(self, mode, t, y, data, f):
        force = -self.F_0 - self.k * y[0] - self.c * y[1]
        return [y[1], (self.push(t, y, f) + force if mode == "contact" else force) / self.m]

    def guards(self, mode, t, y, data, f):
        if mode == "flight":
            return [-self.delta(t, y, f)]
        push = self.push(t, y, f) / self.K
        return [push] if mode == "contact" else [self.delta(t, y, f), -push]

    def jump(self, mode, guard, t, y, data):
        if mode == "leaving":
            return ("flight" if guard == 0 else "contact"), y, data
        return ("contact" if mode == "flight" else "leaving"), y, data


class HuntCrossleyBall(Model):
    """The root of the depth has no series at zero: the surface is a nanometre down, which changes the speed by 1e-14 of itself."""

    name, t_end, start, mode = "hunt_crossley_ball", 2.0, [0.5, 0.0], "flight"
    modes, shift, keeps = ["flight", "contact", "leaving"], 1e-15, True
    scale, stiff = [1e-3, 1.0], False
    surface = -1e-9

    def factor(self, y, speed):
        return 1.0 - 1.5 * (1.0 - 0.8) * y[1] / speed

    def rates(self, mode, t, y, data, f):
        if mode != "contact":
            return [y[1], -9.81 + 0.0 * y[1]]
        return [y[1], 1e8 / 0.1 * -y[0] * f.sqrt(-y[0]) * self.factor(y, data) - 9.81]

    def guards(self, mode, t, y, data, f):
        if mode == "flight":
            return [y[0] - self.surface]
        return [self.surface - y[0]] + ([self.factor(y, data)] if mode == "contact" else [])

    def jump(self, mode, guard, t, y, data):
        if mode == "flight":
            # The speed at the surface itself.
            return "contact", y, math.sqrt(y[1] ** 2 + 2.0 * 9.81 * self.surface)
        return ("flight" if guard == 0 else "leaving"), y, data


class BeltOscillator(Model):
    name, t_end, start, mode = "belt_oscillator", 12.0, [0.9, 0.1], "slower"
    modes, shift = ["slower", "faster", "stick"], 1e-16
    m, k, v_b, F_s, F_k = 2.0, 50.0, 0.3, 8.0, 3.0
    scale, stiff = [8.0 / 50.0, 0.3], False

    def rates(self, mode, t, y, data, f):
        if mode == "stick":
            return [self.v_b + 0.0 * y[0], 0.0 * y[1]]
        return [y[1], ((self.F_k if mode == "slower" else -self.F_k) - self.k * y[0]) / self.m]

    def guards(self, mode, t, y, data, f):
        if mode == "stick":
            return [self.F_s / self.k - y[0], self.F_s / self.k + y[0]]
        return [self.v_b - y[1] if mode == "slower" else y[1] - self.v_b]

    def at_once(self, mode, y):
        if mode != "stick" or abs(self.k * y[0]) <= self.F_s:
            return None
        return 0 if y[0] > 0.0 else 1

    def jump(self, mode, guard, t, y, data):
        if mode != "stick":
            return "stick", [y[0], self.v_b], data
        return ("slower" if guard == 0 else "faster"), y, data


class LugreBrake(Model):
    name, t_end, start, mode = "lugre_brake", 0.3, [0.0, 0.1, 0.0], "sliding"
    modes = ["sliding", "slowing", "forward", "backward", "backward_slowing", "backward_sliding"]
    shift = 1e-17
    sigma_0, sigma_1, sigma_2, F_C, F_S, v_S = 1e5, math.sqrt(1e5), 0.4, 1.0, 1.5, 1e-3
    scale, stiff = [0.005, 0.1, 1e-5], None
    MIRRORED = {"backward": "forward", "backward_slowing": "slowing", "backward_sliding": "sliding"}

    def rates(self, mode, t, y, data, f):
        x, v, z = y
        is_flat, is_back = mode.endswith("sliding"), mode.startswith("backward")
        curve = self.F_C if is_flat else self.F_C + (self.F_S - self.F_C) * f.exp(-((v / self.v_S) ** 2))
        z_dot = v - (-v if is_back else v) / curve * self.sigma_0 * z
        return [v, -(self.sigma_0 * z + self.sigma_1 * z_dot + self.sigma_2 * v), z_dot]

    def guards(self, mode, t, y, data, f):
        v, v_S = y[1], self.v_S
        along = -v if mode.startswith("backward") else v
        return {
            "sliding": [along - 6.0 * v_S],
            "slowing": [along - v_S, 6.0 * v_S - along],
            "forward": [along, v_S - along],
        }[self.MIRRORED.get(mode, mode)]

    def jump(self, mode, guard, t, y, data):
        after = {
            "sliding": ["slowing"],
            "slowing": ["forward", "sliding"],
            "forward": ["backward", "slowing"],
            "backward": ["forward", "backward_slowing"],
            "backward_slowing": ["backward", "backward_sliding"],
            "backward_sliding": ["backward_slowing"],
        }
        return after[mode][guard], y, data


class Joint(Model):
    """A part of the paper's joint: n_X, n_Y, n_turn, arm_X, spread and M are its own."""

    name, t_end, mode = "paper_joint", 2.0, "touch"
    shift = 1e-16
    l, c, r, K, D, mu = 2.5, 1e-4, 4.9e-3, 1e7, 178.7, 0.1
    start = [0.0, -1e-4, 0.0, 0.0, 0.0, 0.0]
    stiff = False
    signs = {"slip+": 1.0, "slip-": -1.0}

    def __init__(self, n_X, n_Y, n_turn, arm_X, spread, M):
        m = 7800.0 * math.pi * 5e-3**2 * self.l
        self.M_X, self.M_Y, self.p, self.q, self.M = n_X * m, n_Y * m, arm_X * self.l, 0.5 * self.l, M
        self.j_0, self.j_c = n_turn * m * 5e-3**2 / 2.0, spread * m * self.l**2
        speed = math.sqrt(2.0 * M * self.p * self.c / (self.j_0 + self.j_c + self.M_X * self.p**2))
        self.scale = [self.c, self.c, self.c / self.l, speed, speed, speed / self.l]

    def slip(self, y):
        """rho times v_T."""
        X, Y, _, v_X, v_Y, omega = y
        return Y * v_X - X * v_Y + math.hypot(X, Y) * self.r * omega

    def state(self, mode, y, f):
        """Sine and cosine, rho and its rate, F_N and its part per rho on the pin, what turns and what it turns."""
        X, Y, theta, v_X, v_Y, omega = y
        s, c = f.sin(theta), f.cos(theta)
        left, moment = self.j_0 + self.j_c * c * c, self.j_c * s * c * omega * omega + self.M
        if mode == "free":
            return s, c, None, None, 0.0, 0.0, moment, left
        rho = f.sqrt(X * X + Y * Y)
        rho_dot = (X * v_X + Y * v_Y) / rho
        F_N = self.K * (rho - self.c) + self.D * rho_dot
        pull = -F_N / rho
        return s, c, rho, rho_dot, F_N, pull, moment - self.p * c * pull * X + self.q * s * pull * Y, left

    def speeding(self, y, f):
        """What v_T does without friction, per newton of friction, and mu F_N."""
        X, Y, _, v_X, v_Y, omega = y
        s, c, rho, rho_dot, F_N, pull, moment, left = self.state("stick", y, f)
        turn = moment / left
        a_X = self.p * s * omega * omega - self.p * c * turn + pull * X / self.M_X
        a_Y = self.q * c * omega * omega + self.q * s * turn + pull * Y / self.M_Y
        v_T_dot = (Y * a_X - X * a_Y - (Y * v_X - X * v_Y) * rho_dot / rho) / rho + self.r * turn
        return v_T_dot, (self.r - (self.p * c * Y + self.q * s * X) / rho) * self.r / left, self.mu * F_N

    def rates(self, mode, t, y, data, f):
        X, Y, _, v_X, v_Y, omega = y
        s, c, _, _, F_N, pull, moment, left = self.state(mode, y, f)
        if mode in self.signs:
            moment = moment - self.signs[mode] * self.mu * self.r * F_N
        elif mode == "stick":
            v_T_dot, per_F_T, _ = self.speeding(y, f)
            moment = moment - self.r * v_T_dot / per_F_T
        turn, omega_sq = moment / left, omega * omega
        a_X = self.p * s * omega_sq - self.p * c * turn + pull * X / self.M_X
        a_Y = self.q * c * omega_sq + self.q * s * turn + pull * Y / self.M_Y
        return [v_X, v_Y, omega, a_X, a_Y, turn]

    def guards(self, mode, t, y, data, f):
        X, Y, theta, v_X, v_Y, omega = y
        end = math.pi / 2.0 - theta
        if mode == "free":
            return [(self.c**2 - X * X - Y * Y) / self.c, end]
        rho = f.sqrt(X * X + Y * Y)
        if mode == "stick":
            v_T_dot, per_F_T, most = self.speeding(y, f)
            return [rho - self.c, per_F_T * most - v_T_dot, v_T_dot + per_F_T * most, end]
        return [rho - self.c, self.signs[mode] / self.c * (Y * v_X - X * v_Y + rho * self.r * omega), end]

    def in_lanes(self, y, par, f):
        """Rates and guards with parameters, and their values for a part in a mode; no stick lasts here."""
        own = copy.copy(self)
        contact, sign = par[0], par[1]
        own.M_X, own.M_Y, own.p, own.q, own.j_0, own.j_c, own.M = [par[2 + i] for i in range(7)]
        own.K, own.D, own.signs = contact * self.K, contact * self.D, {"slip": sign}
        surface, slip, end = own.guards("slip", None, y, None, f)
        # In flight the surface is passed the other way, and there is no slip.
        guards = [(2.0 * contact - 1.0) * surface, slip + 1e-9 * (1.0 - contact), end]

        def constants(part, mode):
            held = {"free": [0.0, 0.0], "slip+": [1.0, 1.0], "slip-": [1.0, -1.0]}[mode]
            return held + [part.M_X, part.M_Y, part.p, part.q, part.j_0, part.j_c, part.M]

        return own.rates("slip", None, y, None, f), guards, constants

    def at_once(self, mode, y):
        if mode not in ("touch", "stick"):
            return None
        if mode == "touch":
            return 1 if (self.slip(y) or self.speeding(y, math)[0]) > 0.0 else 2
        v_T_dot, per_F_T, most = self.speeding(y, math)
        if v_T_dot - per_F_T * most > 0.0:
            return 1
        return 2 if v_T_dot + per_F_T * most < 0.0 else None

    def jump(self, mode, guard, t, y, data):
        if y[2] > math.pi / 2.0 - 1e-9:
            raise RuntimeError("it is deployed")
        if mode == "free":
            return "touch", y, data
        if guard == 0:
            return "free", y, data
        if mode != "touch":
            # Puts v_T to zero.
            X, Y, _, v_X, v_Y, _ = y
            rho_sq = X * X + Y * Y
            v_T = self.slip(y)
            y = [X, Y, y[2], v_X - v_T * Y / rho_sq, v_Y + v_T * X / rho_sq, y[5]]
        if mode in self.signs:
            return "stick", y, data
        return ("slip+" if guard == 1 else "slip-"), y, data


class PaperJoint(Joint):
    def __init__(self):
        pass

    def parts(self):
        return [Joint(5, 4, 4, 1.2, 1.8, 1.0), Joint(4, 2, 2, 0.75, 0.25, 0.3)]


MODELS = [MassAgainstStop(), CamFollower(), HuntCrossleyBall(), BeltOscillator(), LugreBrake(), PaperJoint()]
