// What every peer in C++ shares: the grid of samples, the ladder of tolerances, the stopwatch, and the
// line format that the Rust program reads (`src/script.rs`).
#pragma once

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model.hpp"

inline constexpr int N_SAMPLES = 200;
inline constexpr double SPACING = 0.01, T_END = 2.0;
// Right-hand sides at which a run is given up.
inline constexpr long MAX_RHS = 100000000;

// Seconds on the processor, from the environment.
inline double seconds(const char* name, double otherwise) {
    const char* text = std::getenv(name);
    return text ? std::atof(text) : otherwise;
}
// For the longest run of a ladder, and for the repeats of a run.
inline const double LONGEST = seconds("PEERS_LONGEST", 1.0), BUDGET = seconds("PEERS_BUDGET", 0.3);

inline double sample_time(int k) { return k == N_SAMPLES ? T_END : SPACING * k; }

struct Change {
    double t;
    int before, after;
};

// What a run delivers of one joint.
struct Track {
    std::vector<State> samples;
    std::vector<Change> events;
    long n_rhs = 0;
    int mode = 0;

    // Looks at the end of a step of a naive run.
    template <class Y>
    void look(const Joint& joint, double t, const Y& y) { change(t, joint.mode_of(y)); }

    void change(double t, int after) {
        if (after != mode) events.push_back({t, mode, after});
        mode = after;
    }

    template <class Y>
    void sample(const Y& y) { samples.push_back({y[0], y[1], y[2], y[3], y[4], y[5]}); }

    double next_sample() const {
        return samples.size() < N_SAMPLES ? sample_time(int(samples.size()) + 1) : 1e300;
    }
};

// Seconds by the clock on the wall, and of this thread on the processor.
struct Times {
    double wall, cpu;
};

inline Times now() {
    const auto seconds = [](clockid_t clock) {
        timespec time;
        clock_gettime(clock, &time);
        return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
    };
    return {seconds(CLOCK_MONOTONIC), seconds(CLOCK_THREAD_CPUTIME_ID)};
}

// A run of both joints.
using Solve = std::function<void(double rtol, Track tracks[2])>;

// Runs a method over the ladder, 1e-3 ... 1e-13 in quarters of a decade, and prints its lines.
inline void ladder(const char* tool, const std::string& version, const char* method,
                   const char* handling, const char* folder, const Solve& solve) {
    const auto once = [&](double rtol, Track tracks[2]) {
        const Times begin = now();
        for (int j = 0; j < 2; ++j) {
            tracks[j] = Track();
            tracks[j].samples.reserve(N_SAMPLES);
        }
        solve(rtol, tracks);
        const Times end = now();
        return Times{end.wall - begin.wall, end.cpu - begin.cpu};
    };
    const char* const digits[] = {"1", "5.6", "3.2", "1.8"};
    for (int k = 0; k <= 40; ++k) {
        const std::string text = digits[k % 4] + ("e-" + std::to_string(3 + (k + 3) / 4));
        const double rtol = std::stod(text);
        Track tracks[2];
        try {
            Times best = once(rtol, tracks);
            double spent = best.cpu;
            int repeats = 1;
            for (; spent + 0.5 * best.cpu < BUDGET; ++repeats) {
                const Times taken = once(rtol, tracks);
                spent += taken.cpu;
                best = {std::min(best.wall, taken.wall), std::min(best.cpu, taken.cpu)};
            }
            const std::string name = std::string(tool) + "-" + method + "-" + handling + "-" + text;
            FILE* file = std::fopen((std::string(folder) + "/" + name).c_str(), "w");
            if (!file) throw std::runtime_error("cannot write " + name);
            for (int j = 0; j < 2; ++j) {
                for (const State& y : tracks[j].samples)
                    std::fprintf(file, "s,%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", j + 1, y[0], y[1],
                                 y[2], y[3], y[4], y[5]);
                for (const Change& e : tracks[j].events)
                    std::fprintf(file, "e,%d,%.17g,%d,%d\n", j + 1, e.t, e.before, e.after);
            }
            std::fclose(file);
            std::printf("run,%s,%s,%s,%s,%s,%ld,%.6f,%.6f,%d,%s\n", tool, version.c_str(), method, handling,
                        text.c_str(), tracks[0].n_rhs + tracks[1].n_rhs, 1e3 * best.wall,
                        1e3 * best.cpu, repeats, name.c_str());
            if (best.cpu > LONGEST) break;
        } catch (const std::exception& error) {
            std::printf("failed,%s,%s,%s,%s,%s,%s\n", tool, version.c_str(), method, handling,
                        text.c_str(), error.what());
        }
        std::fflush(stdout);
    }
}
