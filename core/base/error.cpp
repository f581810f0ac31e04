#include "core/base/error.h"

namespace palpate {
namespace {

Error make(ErrorKind kind, std::string message) {
  Error error;
  error.kind = kind;
  error.message = std::move(message);
  return error;
}

}  // namespace

Error usageError(std::string message) {
  return make(ErrorKind::Usage, std::move(message));
}
Error inputRefused(std::string message) {
  return make(ErrorKind::InputRefused, std::move(message));
}
Error machineError(std::string message) {
  return make(ErrorKind::Machine, std::move(message));
}
Error cancelled(std::string message) {
  return make(ErrorKind::Cancelled, std::move(message));
}
Error checkFailed(std::string message) {
  return make(ErrorKind::CheckFailed, std::move(message));
}

int exitCode(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::CheckFailed:
      return 1;
    case ErrorKind::Usage:
      return 2;
    case ErrorKind::InputRefused:
      return 3;
    case ErrorKind::Machine:
      return 4;
    case ErrorKind::Cancelled:
      return 5;
  }
  return 4;
}

const char* kindName(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::CheckFailed:
      return "check-failed";
    case ErrorKind::Usage:
      return "usage";
    case ErrorKind::InputRefused:
      return "input-refused";
    case ErrorKind::Machine:
      return "machine";
    case ErrorKind::Cancelled:
      return "cancelled";
  }
  return "machine";
}

std::string sentence(const Error& error) {
  std::string text = error.message;
  const auto part = [&text](const char* word, const std::optional<std::string>& value) {
    if (value) text += std::string(" ") + word + *value + ".";
  };
  part("File: ", error.file);
  part("Field: ", error.field);
  part("Found: ", error.found);
  part("Expected: ", error.expected);
  if (error.advice) text += " " + *error.advice;
  return text;
}

}  // namespace palpate
