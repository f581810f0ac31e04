#pragma once
/// What every part of Palpate returns when input or the machine says no.
///
/// An Error carries what a person needs to act: the sentence, and where it applies the file, the
/// field, what was found, what was expected, and what to do next (interface.md, "Common rules").
/// Errors are returned, never thrown, across the rooms. Nothing in the servo or the step makes one.

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace palpate {

/// The kinds map one to one to the program's exit codes.
enum class ErrorKind {
  CheckFailed,   ///< 1: the check that was asked for failed (a replay that is not identical).
  Usage,         ///< 2: the command or call itself is wrong.
  InputRefused,  ///< 3: a file or value from outside is not acceptable.
  Machine,       ///< 4: the machine or a file system said no.
  Cancelled,     ///< 5: the user stopped it.
};

struct Error {
  ErrorKind kind = ErrorKind::InputRefused;
  std::string message;  ///< One sentence: what happened. No patient name, identifier or UID.
  std::optional<std::string> file;
  std::optional<std::string> field;
  std::optional<std::string> found;
  std::optional<std::string> expected;
  std::optional<std::string> advice;  ///< One sentence: what to do.

  // Chained setters, so that an error reads as one expression where it is made.
  Error& inFile(std::string v) & {
    file = std::move(v);
    return *this;
  }
  Error& inField(std::string v) & {
    field = std::move(v);
    return *this;
  }
  Error& butFound(std::string v) & {
    found = std::move(v);
    return *this;
  }
  Error& wants(std::string v) & {
    expected = std::move(v);
    return *this;
  }
  Error& advise(std::string v) & {
    advice = std::move(v);
    return *this;
  }
  Error&& inFile(std::string v) && {
    file = std::move(v);
    return std::move(*this);
  }
  Error&& inField(std::string v) && {
    field = std::move(v);
    return std::move(*this);
  }
  Error&& butFound(std::string v) && {
    found = std::move(v);
    return std::move(*this);
  }
  Error&& wants(std::string v) && {
    expected = std::move(v);
    return std::move(*this);
  }
  Error&& advise(std::string v) && {
    advice = std::move(v);
    return std::move(*this);
  }
};

template <class T>
using Result = tl::expected<T, Error>;

/// `return refuse("...").inFile(path).advise("...");` needs fail() around it: Result is built from
/// an unexpected value.
[[nodiscard]] inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

[[nodiscard]] Error usageError(std::string message);
[[nodiscard]] Error inputRefused(std::string message);
[[nodiscard]] Error machineError(std::string message);
[[nodiscard]] Error cancelled(std::string message = "Cancelled.");
[[nodiscard]] Error checkFailed(std::string message);

/// 1 to 5, as in interface.md.
[[nodiscard]] int exitCode(ErrorKind kind);
/// "usage", "input-refused", ...: the word in the JSON error object.
[[nodiscard]] const char* kindName(ErrorKind kind);
/// The one line a person reads: message, file, field, found, expected, advice, as far as they
/// apply.
[[nodiscard]] std::string sentence(const Error& error);

}  // namespace palpate
