#pragma once
/// The program as a function: parse, run one command or the desktop, print, exit code.

namespace palpate {

/// main()'s arguments; main's thread; once a process. Returns 0 to 5 as in interface.md.
[[nodiscard]] int runProgram(int argc, char** argv);

}  // namespace palpate
