#include "app/program.h"

int main(int argc, char** argv) {
  return palpate::runProgram(argc, argv);
}
