#include "app/accuracy.h"

#include <algorithm>

namespace palpate {

std::string accuracyNames() {
  return "recorded, fine, reference";
}

Result<SimulationSetting> settingOfAccuracy(const std::string& name, SimulationSetting recorded) {
  if (name == kRecordedAccuracy) return recorded;
  if (name != "fine" && name != "reference") {
    return fail(usageError("There is no accuracy of that name.")
                    .inField("--accuracy")
                    .butFound(name)
                    .wants("one of " + accuracyNames())
                    .advise("Choose one of these."));
  }
  SimulationSetting setting = recorded;
  setting.tree.leaf = LeafModel::Distance;
  setting.tree.surfaceOnly = false;
  setting.query.stopLevel = 0;
  setting.query.contactBudget = QueryOptions{}.contactBudget;
  setting.query.perceptualBound = 0.0;
  setting.solverIterations = std::max(setting.solverIterations, 1000U);
  if (name == "reference") setting.query.method = QueryMethod::BruteForce;
  return setting;
}

Result<std::shared_ptr<const PreparedScene>> withSetting(const PreparedScene& prepared,
                                                         const SimulationSetting& setting,
                                                         const Progress& progress) {
  Scene scene = prepared.scene;
  scene.setting = setting;
  scene.X_WD = prepared.X_WD;  // the device stays where it stood
  return prepareScene(scene, prepared.labels, prepared.table, prepared.materials,
                      prepared.instrument, progress);
}

}  // namespace palpate
