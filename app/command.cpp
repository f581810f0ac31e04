#include "app/command.h"

namespace palpate {

CLI::App* CommandSet::add(const std::string& name, const std::string& description,
                          CommandFunction run) {
  CLI::App* subcommand = program_.add_subcommand(name, description);
  subcommand->fallthrough();  // --json, --progress and the limits stand before or after the name
  entries_.push_back({subcommand, std::move(run)});
  return subcommand;
}

const CommandFunction* CommandSet::chosen() const {
  for (const Entry& entry : entries_) {
    if (entry.subcommand->parsed()) return &entry.run;
  }
  return nullptr;
}

}  // namespace palpate
