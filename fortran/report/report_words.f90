!> The possible words of columns and keys of a run's files.
module report_words
   implicit none(type, external)
   private

   public :: contact_words, end_words, event_words, joint_words, slip_words, status_words, &
             well_words, word_t

   !> A possible word of a column or key.
   type :: word_t
      character(len=16) :: word = ""
      character(len=208) :: meaning = ""
   end type word_t

   ! The tables keep their own layout.
   !&<
   type(word_t), parameter :: contact_words(*) = [ &
      word_t("stick", "closed, no slip increment"), &
      word_t("slip", "closed, slipping"), &
      word_t("open", "open")]

   type(word_t), parameter :: event_words(*) = [ &
      word_t("slip_onset", "a fracture slips for the first time"), &
      word_t("opening", "a fracture opens for the first time"), &
      word_t("growth_onset", "a tip begins to grow; `detail` has the uncertainty of the time"), &
      word_t("growth", "a tip has grown, to the given position"), &
      word_t("joint", "a tip has joined a fracture or the boundary"), &
      word_t("arrest", "a tip has stopped permanently, for the reason in `detail`"), &
      word_t("step_cut", &
         "a time step did not converge, had too large a time error, or tips would begin to "// &
         "grow or grow too far in it: it is repeated with a shorter step"), &
      word_t("replay", &
             "a replay has left the record, for the reason in `detail`, and decides freely"), &
      word_t("unstable_growth", &
         "tips have grown at constant time until they arrested, or exceed K_IC in the initial "// &
         "state and grow at once; without a fluid a row at the start and one at the end, with "// &
         "the energy released"), &
      word_t("bifurcation", &
         "tips grow together, but any difference between them would grow: one of them may "// &
         "advance ahead of the others; or one of equal tips is ahead, by chance"), &
      word_t("remesh", "the mesh was updated after growth, or with &adaptive before the first "// &
             "step; `detail` has its cells"), &
    word_t("well", &
         "a stage of a well begins, it is shut in, or it reaches or leaves its pressure limit; "// &
         "see `detail`"), &
      word_t("growth_jump", &
        "with a fluid, a tip has grown without equilibrium in a step too short to matter, from "// &
         "the given position; `detail` has its length, the well pressure before and after, and "// &
         "the error of the time"), &
      word_t("growth_uncertain", &
         "a tip grows or may grow, but the error of its K makes the pressure, the load factor "// &
         "or the position uncertain; see `detail`"), &
      word_t("window", &
         "stress intensity factors of a tip that would grow are too uncertain: its window is "// &
         "enlarged or refined; see `detail`")]

   type(word_t), parameter :: end_words(*) = [ &
      word_t("stick", "no cell of it slips any more"), &
      word_t("speed", "its slip rate passed seismic_slip_rate; slip continues as another event"), &
      word_t("run", "the run ended during slip")]

   type(word_t), parameter :: slip_words(*) = [ &
      word_t("seismic", "faster than seismic_slip_rate"), &
      word_t("aseismic", "slower")]

   type(word_t), parameter :: joint_words(*) = [ &
      word_t("boundary", "a fracture ends on the outer boundary"), &
      word_t("T", "a fracture ends on another one"), &
      word_t("X", "two fractures cross"), &
      word_t("V", "the ends of two fractures meet")]

   type(word_t), parameter :: status_words(*) = [ &
      word_t("finished", "the end of the scene was reached"), &
      word_t("stopped", "interrupted from outside"), &
      word_t("failed", "the run could not continue")]

   type(word_t), parameter :: well_words(*) = [ &
      word_t("rate", "the prescribed rate"), &
      word_t("pressure", "the prescribed pressure"), &
      word_t("limit", &
         "the pressure limit of a rate; no flow if the pressure around the well exceeds it"), &
      word_t("shut", &
         "no rate at the head: before its start, or after its end, when stored fluid still flows")]
   !&>

end module report_words
