#include "tests/benchmarks/runner.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace palpate::bench {
namespace {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

struct Record {
  std::vector<std::vector<double>> micros;  // [step][pass]
  std::vector<double> contacts;             // [step]
  double tests = 0;
};

void onePass(Peer& peer, const Trajectory& trajectory, ContactList& out, bool keep,
             Record& record) {
  peer.reset();
  for (std::size_t i = 0; i < trajectory.X_VT.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    peer.find(trajectory.X_VT[i], out);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    if (!keep) continue;
    record.micros[i].push_back(took.count());
    record.contacts[i] = static_cast<double>(out.count);
    record.tests += static_cast<double>(peer.tests());
  }
}

Timing summary(const Record& record) {
  Timing t;
  std::vector<double> all;
  std::vector<double> touching;
  std::vector<double> contacts;
  for (std::size_t i = 0; i < record.micros.size(); ++i) {
    all.push_back(quantile(record.micros[i], 0.5));
    t.worstRaw = std::max(t.worstRaw, quantile(record.micros[i], 1.0));
    t.tests += 0.0;
    if (record.contacts[i] > 0) {
      touching.push_back(all.back());
      contacts.push_back(record.contacts[i]);
    }
  }
  t.p50 = quantile(all, 0.5);
  t.p99 = quantile(all, 0.99);
  t.worst = quantile(all, 1.0);
  t.p50Touching = quantile(touching, 0.5);
  t.contacts = quantile(contacts, 0.5);
  t.maxContacts = static_cast<std::size_t>(quantile(contacts, 1.0));
  const double calls = static_cast<double>(record.micros.size()) *
                       static_cast<double>(record.micros.empty() ? 1 : record.micros[0].size());
  t.tests = record.tests / std::max(1.0, calls);
  return t;
}

}  // namespace

std::vector<Timing> timePeers(const std::vector<std::unique_ptr<Peer>>& peers,
                              const Trajectory& trajectory, std::size_t capacity, int passes) {
  ContactList out(capacity);
  std::vector<Record> records(peers.size());
  for (Record& record : records) {
    record.micros.resize(trajectory.X_VT.size());
    record.contacts.resize(trajectory.X_VT.size());
  }
  for (int pass = -1; pass < passes; ++pass) {  // the first one warms up
    for (std::size_t i = 0; i < peers.size(); ++i) {
      onePass(*peers[i], trajectory, out, pass >= 0, records[i]);
    }
  }
  std::vector<Timing> timings;
  for (const Record& record : records) timings.push_back(summary(record));
  return timings;
}

Agreement compare(Peer& reference, Peer& peer, const Trajectory& trajectory, std::size_t capacity,
                  std::size_t stride) {
  Agreement result;
  ContactList a(capacity);
  ContactList b(capacity);
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> at(capacity);
  for (std::size_t i = 0; i < trajectory.X_VT.size(); i += stride) {
    reference.find(trajectory.X_VT[i], a);
    peer.find(trajectory.X_VT[i], b);
    peer.collect(b);
    std::fill(at.begin(), at.end(), kNone);
    for (std::size_t k = 0; k < b.count; ++k) at[b.index[k]] = k;
    std::size_t different = 0;
    for (std::size_t k = 0; k < a.count; ++k) {
      const std::size_t other = at[a.index[k]];
      if (other == kNone) {
        ++different;
        result.deepestDifferent = std::max<double>(result.deepestDifferent, a.depth[k]);
        continue;
      }
      at[a.index[k]] = kNone;
      result.depthError =
          std::max<double>(result.depthError, std::abs(a.depth[k] - b.depth[other]));
      if (a.depth[k] < 0.01f) continue;
      const double cosine = a.nx[k] * b.nx[other] + a.ny[k] * b.ny[other] + a.nz[k] * b.nz[other];
      result.normalError = std::max(result.normalError, std::acos(std::clamp(cosine, -1.0, 1.0)));
    }
    for (const std::size_t k : at) {
      if (k == kNone) continue;
      ++different;
      result.deepestDifferent = std::max<double>(result.deepestDifferent, b.depth[k]);
    }
    ++result.steps;
    result.differentPoints += different;
    if (different > 0) ++result.differentSteps;
  }
  return result;
}

}  // namespace palpate::bench
