#include "geo/foreign.hpp"

int main(int argc, char** argv) {
    talus::geo::read_foreign(argc, argv);
    return 1;
}
