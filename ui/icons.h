#pragma once
/// Code points of Font Awesome 4.7 (Debian: fonts-font-awesome), merged into the text font.

namespace palpate::ui::icon {

inline constexpr const char* kFolder = "\xef\x81\xbb";
inline constexpr const char* kFolderOpen = "\xef\x81\xbc";
inline constexpr const char* kFile = "\xef\x80\x96";
inline constexpr const char* kImport = "\xef\x80\x99";
inline constexpr const char* kCube = "\xef\x86\xb2";
inline constexpr const char* kCubes = "\xef\x86\xb3";
inline constexpr const char* kPlay = "\xef\x81\x8b";
inline constexpr const char* kStop = "\xef\x81\x8d";
inline constexpr const char* kRecord = "\xef\x84\x91";
inline constexpr const char* kUndo = "\xef\x83\xa2";
inline constexpr const char* kReset = "\xef\x80\xa1";
inline constexpr const char* kHand = "\xef\x89\x96";
inline constexpr const char* kMouse = "\xef\x89\x85";
inline constexpr const char* kWarning = "\xef\x81\xb1";
inline constexpr const char* kInfo = "\xef\x81\x9a";
inline constexpr const char* kCheck = "\xef\x80\x8c";
inline constexpr const char* kClose = "\xef\x80\x8d";
inline constexpr const char* kHistory = "\xef\x87\x9a";
inline constexpr const char* kUp = "\xef\x85\x88";
inline constexpr const char* kHome = "\xef\x80\x95";
inline constexpr const char* kCrosshair = "\xef\x81\x9b";
inline constexpr const char* kEye = "\xef\x81\xae";
inline constexpr const char* kEyeOff = "\xef\x81\xb0";
inline constexpr const char* kMagic = "\xef\x83\x90";
inline constexpr const char* kBolt = "\xef\x83\xa7";
inline constexpr const char* kLock = "\xef\x80\xa3";
inline constexpr const char* kQuestion = "\xef\x84\xa8";
inline constexpr const char* kDot = "\xef\x84\x91";
inline constexpr const char* kSave = "\xef\x83\x87";
inline constexpr const char* kExpand = "\xef\x81\xa5";
inline constexpr const char* kCompress = "\xef\x81\xa6";
inline constexpr const char* kFilm = "\xef\x80\x88";
inline constexpr const char* kChevronDown = "\xef\x81\xb8";
inline constexpr const char* kAngleRight = "\xef\x84\x85";
inline constexpr const char* kLeaf = "\xef\x81\xac";
inline constexpr const char* kCircle = "\xef\x86\x92";
inline constexpr const char* kTint = "\xef\x81\x83";
inline constexpr const char* kBrush = "\xef\x87\xbc";
inline constexpr const char* kEraser = "\xef\x84\xad";
inline constexpr const char* kScissors = "\xef\x83\x84";
inline constexpr const char* kCrop = "\xef\x84\xa5";
inline constexpr const char* kFork = "\xef\x84\xa6";
inline constexpr const char* kPlus = "\xef\x81\xa7";
inline constexpr const char* kRedo = "\xef\x80\x9e";
inline constexpr const char* kPencil = "\xef\x81\x80";
inline constexpr const char* kTrash = "\xef\x87\xb8";
inline constexpr const char* kHandUp = "\xef\x82\xa6";
inline constexpr const char* kSun = "\xef\x86\x85";

}  // namespace palpate::ui::icon
