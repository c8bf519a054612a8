#include "difi/compute.h"
