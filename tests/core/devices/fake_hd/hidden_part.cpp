// Stands for the vendor's lower library, which its HDAPI library needs without saying more.
extern "C" int phantomIoLibrary() {
  return 42;
}
