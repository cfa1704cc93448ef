#include "import/import.hpp"

int main(int argc, char** argv) {
    return clarity::import_worker_main(argc, argv);
}
