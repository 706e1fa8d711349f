/* The image of a model: a header of words of 8 bytes, then pieces, each at a multiple of 64 bytes.

   header: magic, version, size of the image, 0, its SHA-256 (4), (offset, bytes) of each piece,
   numbers. Doubles among the numbers are kept by their bits. fmu/image.py reads the names below. */
#ifndef DUHAMEL_IMAGE_H
#define DUHAMEL_IMAGE_H

enum {
    HEADER_MAGIC, HEADER_VERSION, HEADER_SIZE, HEADER_DIGEST = 4, HEADER_PIECES = 8
};

enum Piece {
    PIECE_WORDS,           /* of Run, that of long steps, Inputs, those of no step, rows left out */
    PIECE_RELOCATIONS,     /* (word, segment, offset) of each address */
    PIECE_CONSTANT,        /* arrays that no step changes */
    PIECE_LIVE,            /* all others, before the first step is prepared */
    PIECE_SIGNALS,         /* signals that are no inputs: a row for each step */
    PIECE_SIGNAL_PLACES,   /* in the live arrays, one for each column */
    PIECE_VARIABLES,       /* `Variable` of each value reference */
    PIECE_PARAMETERS,      /* place of each parameter in the constant arrays */
    PIECE_INPUTS,          /* (input, place in the live arrays) */
    PIECE_BRANCHES,        /* rows of joints that must stay on their branch */
    PIECE_SHORT,           /* 1 of each long step that corners of signals forbid */
    PIECE_REMOVED,         /* redundant constraints that were left out */
    PIECE_REMOVED_LIMITS,  /* openings that they may have */
    PIECE_FRAMES,          /* the names of frames, by their places in the texts */
    PIECE_ROWS,            /* the names of the owners of rows */
    PIECE_CONTACTS,        /* the names of contacts */
    PIECE_REMOVED_NAMES,
    PIECE_TEXTS,
    N_PIECES
};

enum Number {
    WORD_OF_FLIGHT, WORD_OF_FLYING_SYSTEM, WORD_OF_SYSTEM, WORD_OF_STATE,
    WORD_OF_WORK, WORD_OF_COUPLINGS, WORD_OF_INPUTS, WORD_OF_NO_STEP, WORD_OF_REMOVED_ROWS,
    PLACE_OF_IN_FLIGHT, PLACE_OF_LEFT, PLACE_OF_PASSED, PLACE_OF_N_EVENTS, PLACE_OF_ROW,
    PLACE_OF_CURRENT, PLACE_OF_PHI, PLACE_OF_COMPLIANT, PLACE_OF_SHORTEST, PLACE_OF_SWITCHING, PLACE_OF_MOVED,
    PLACE_OF_FIRST, PLACE_OF_P, PLACE_OF_U_AHEAD,
    N_INPUTS, N_ROWS, N_COUPLED_CONTACTS, N_CONTACTS, N_DOFS, N_PAST,
    N_STEPS, RATIO, SPAN, STEP, TOLERANCE, END, MOST_CREATED, FEW_STEPS, GOOD_STEPS,
    N_NUMBERS
};
#endif
