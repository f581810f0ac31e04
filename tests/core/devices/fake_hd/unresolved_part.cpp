// As the vendor's library does with ncurses: calls a function of a library that it does not name.
extern "C" int wgetchOfNowhere();
extern "C" int hdInitDevice(const char*) {
  return wgetchOfNowhere();
}
