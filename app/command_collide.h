#pragma once
/// `palpate collide`: contacts only, over a trajectory from a file.

namespace palpate {

class CommandSet;

void addCollideCommand(CommandSet& commands);

}  // namespace palpate
