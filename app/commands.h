#pragma once
/// Every command of the program, each in its own app/command_<name>.cpp.

namespace palpate {

class CommandSet;

void addImportCommand(CommandSet& commands);
void addSeriesCommand(CommandSet& commands);
void addSegmentCommand(CommandSet& commands);
void addCompareCommand(CommandSet& commands);
void addTreeCommand(CommandSet& commands);
void addSimulateCommand(CommandSet& commands);
void addExportCommand(CommandSet& commands);
void addReplayCommand(CommandSet& commands);
void addTradeoffCommand(CommandSet& commands);
void addDevicesCommand(CommandSet& commands);
void addDoctorCommand(CommandSet& commands);

}  // namespace palpate
