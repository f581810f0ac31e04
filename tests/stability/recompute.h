#pragma once
/// Energy, slew and clamps recomputed from what left the program, in a few lines that share nothing
/// with the safety: only the numbers of ServoSample.

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/haptics/servo_loop.h"

namespace palpate::stability {

struct Recomputed {
  double lowestEnergy = 0.0;   ///< J: of -Σ F[k-1]·(x[k] - x[k-1]) and torque likewise
  double finalEnergy = 0.0;    ///< J
  double largestForce = 0.0;   ///< N
  double largestRise = 0.0;    ///< N a tick: rise or turn; a fall of magnitude is free
  double largestTorque = 0.0;  ///< N·m
  int longestAbove = 0;        ///< ticks in a row above the continuous limit
  double roughness = 0.0;      ///< N a tick: mean |F[k] - F[k-1]| of the worst 200 ticks
};

inline Recomputed recompute(const std::vector<ServoSample>& s, double continuousForce) {
  Recomputed r;
  int above = 0;
  double window = 0.0;
  std::vector<double> changes(s.size(), 0.0);
  for (std::size_t k = 1; k < s.size(); ++k) {
    const ServoSample &a = s[k - 1], &b = s[k];
    const double *f = a.wrench.force, *g = b.wrench.force, *p = a.device.pose.q,
                 *q = b.device.pose.q;
    // Vector part of q·p*: half the turn, for small turns.
    const double turn[3] = {2 * (-q[0] * p[1] + q[1] * p[0] - q[2] * p[3] + q[3] * p[2]),
                            2 * (-q[0] * p[2] + q[1] * p[3] + q[2] * p[0] - q[3] * p[1]),
                            2 * (-q[0] * p[3] - q[1] * p[2] + q[2] * p[1] + q[3] * p[0])};
    for (int i = 0; i < 3; ++i) {
      r.finalEnergy -= f[i] * (b.device.pose.p[i] - a.device.pose.p[i]);
      r.finalEnergy -= a.wrench.torque[i] * turn[i];
    }
    r.lowestEnergy = std::min(r.lowestEnergy, r.finalEnergy);
    const double m = std::hypot(f[0], f[1], f[2]), n = std::hypot(g[0], g[1], g[2]);
    const double kept = n < m ? n / m : 1.0;
    r.largestForce = std::max(r.largestForce, n);
    r.largestRise = std::max(
        r.largestRise, std::hypot(g[0] - kept * f[0], g[1] - kept * f[1], g[2] - kept * f[2]));
    const double* t = b.wrench.torque;
    r.largestTorque = std::max(r.largestTorque, std::hypot(t[0], t[1], t[2]));
    above = n > continuousForce * (1 + 1e-9) ? above + 1 : 0;
    r.longestAbove = std::max(r.longestAbove, above);
    changes[k] = std::hypot(g[0] - f[0], g[1] - f[1], g[2] - f[2]);
    window += changes[k] - (k > 200 ? changes[k - 200] : 0.0);
    r.roughness = std::max(r.roughness, window / 200.0);
  }
  return r;
}

}  // namespace palpate::stability
