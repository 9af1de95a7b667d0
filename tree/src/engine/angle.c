#include <dm2/net/in_net.h>
