  #  include "dm2/deck/in_deck.h"
