/// Speed against accuracy in the window: measured when a scene is ready, chosen under the deadline,
/// shown as a front whose marker the user moves.

#include <algorithm>

#include "app/accuracy.h"
#include "app/desktop_loop.h"
#include "core/simulation/plan.h"

namespace palpate {
namespace {

ui::TradeRowModel rowModel(const TradeRow& row) {
  return {row.name, row.depth_mm, row.force_N, row.p99_us, row.p999_us, row.onFront};
}

}  // namespace

/// A scene is ready at the case's own setting, or at the chosen one. @param key  tradeKey() of it.
void Desktop::considerTrade(const std::string& key) {
  if (key == tradeKey_) return showTrade();
  tradeKey_ = key;
  trade_.reset();
  if (open_) trade_ = readTradeMemo(open_->folder, key);
  showTrade();
  if (trade_) return applyTrade(trade_->chosen);
  // Pictures, scripts and soaks say themselves what is measured, and when.
  if (!options_.screenshot && !options_.uiScript && options_.soak_s <= 0.0) measureTrade();
}

void Desktop::measureTrade() {
  const auto scene = simulation_.shared();
  if (!scene || simulation_.running()) return;
  const auto work = [this, scene, own = ownSetting_, changed = appliedTrade_ != "default",
                     device = simulation_.info(),
                     key = tradeKey_](const Progress& progress) -> JobQueue::Completion {
    Result<std::shared_ptr<const PreparedScene>> declared = scene;
    if (changed) declared = withSetting(*scene, own, {nullptr, progress.cancel});
    const auto memo = declared ? measureTradeMemo(**declared, device, progress)
                               : Result<TradeMemo>(fail(declared.error()));
    return [this, key, memo] {
      if (!memo) return complain(memo.error(), "Nothing was measured.");
      if (key == tradeKey_ && open_) takeTrade(*memo);
    };
  };
  jobs_.addIdle("Measuring speed and accuracy", work);
}

void Desktop::takeTrade(const TradeMemo& memo) {
  trade_ = memo;
  if (auto written = writeTradeMemo(open_->folder, tradeKey_, memo); !written) {
    complain(written.error(), "It is measured again when the case is opened.");
  }
  showTrade();
  applyTrade(memo.chosen);
}

void Desktop::chooseTrade(const std::string& name) {
  if (!trade_ || !open_) return;
  trade_->chosen = name;
  (void)writeTradeMemo(open_->folder, tradeKey_, *trade_);  // the choice holds for now all the same
  showTrade();
  applyTrade(name);
}

/// Makes the scene ready at a row's setting, with what a governor may step down to, beside the
/// window; the present one stays until then.
void Desktop::applyTrade(const std::string& name) {
  const auto scene = simulation_.shared();
  const auto setting = scene ? settingOfRow(name, ownSetting_, scene->instrument) : std::nullopt;
  if (!setting || !trade_) return;
  const bool inForce = name == appliedTrade_;
  if (inForce && !scene->levels.empty()) return;
  appliedTrade_ = name;
  jobs_.addLatest("Applying the setting",
                  [this, scene, inForce, setting = *setting, own = ownSetting_,
                   memo = *trade_](const Progress& progress) {
                    Result<std::shared_ptr<const PreparedScene>> prepared = scene;
                    if (!inForce) prepared = withSetting(*scene, setting, progress);
                    if (prepared) prepared = governed(*prepared, own, memo);
                    return [this, scene, prepared] {
                      if (simulation_.shared() != scene) return;
                      if (!prepared)
                        return complain(prepared.error(), "The simulation is as it was.");
                      for (const PlanRow& now : (*prepared)->plan) {
                        for (PlanRow& shown : model_.simulate.plan) {
                          if (now.what == kGovernorRow && shown.what == now.what) shown = now;
                        }
                      }
                      takeScene(*prepared);
                    };
                  });
}

/// Another case is opened.
void Desktop::forgetTrade() {
  tradeKey_.clear();
  trade_.reset();
  appliedTrade_ = "default";
  showTrade();
}

void Desktop::showTrade() {
  ui::TradeModel& model = model_.simulate.trade;
  model = {};
  model.limit_us = 1e6 * kTradeHeadroom * ownSetting_.stepPeriod;
  if (!trade_) return;
  for (const TradeRow& row : trade_->rows) {
    if (row.name == trade_->chosen) model.chosen = model.rows.size();
    model.rows.push_back(rowModel(row));
  }
}

}  // namespace palpate
