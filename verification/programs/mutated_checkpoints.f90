!> Checkpoints with wrong values and a right checksum, loaded as by a restart (docs/sweeps.md):
!!
!!    mutated_checkpoints FIRST LAST STEPS FOLDER ...
!!
!! Each number from FIRST to LAST stands for one mutated state of the run in one of the folders,
!! which have scene.nml and checkpoint.bin. Every STEPS-th that can be loaded goes on by a state.
!! Each is loaded by a separate process: one that a signal or the run time ends is printed with its
!! number and the change.
program mutated_checkpoints
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit, int8, output_unit
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk
   use base_number, only: integer_text
   use base_timers, only: timers_t
   use mechanics_simulation, only: mechanics_simulation_t
   use report_files, only: read_bytes
   use report_restart, only: restartable_t
   use scene_namelist, only: read_scene
   use scene_types, only: scene_t
   use testing_random, only: random_t
   use twolevel_state, only: two_levels_t
   use verification_files, only: integer_argument, stop_on, text_argument
   implicit none(type, external)

   interface
      ! POSIX.
      integer(c_int) function alarm(seconds) bind(c)
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: seconds
      end function alarm
      integer(c_int) function fork() bind(c)
         import :: c_int
         implicit none(type, external)
      end function fork
      integer(c_int) function waitpid(id, status, options) bind(c)
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: id, options
         integer(c_int), intent(out) :: status
      end function waitpid
      subroutine leave(status) bind(c, name="_exit")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: status
      end subroutine leave
   end interface

   !> An entry with values: its bytes `first` to `last`, those of its rank and its values.
   type :: entry_t
      character(len=32) :: name = ""
      character(len=2) :: kind = ""
      integer(lk) :: rank_at = 0_lk, values_at = 0_lk, last = 0_lk
      integer(ik) :: ranks = 0_ik
   end type entry_t

   !> The state of a run.
   type :: base_t
      type(scene_t) :: scene
      integer(int8), allocatable :: bytes(:)
      type(entry_t), allocatable :: entries(:)
   end type base_t

   integer(c_int), parameter :: time_limit = 60_c_int  !< for one of them [s]
   ! What becomes of one.
   integer, parameter :: is_refused = 10, has_error = 11, is_loaded = 12, goes_on = 13, stops = 14
   integer(lk), parameter :: head_size = 32_lk
   type(base_t), allocatable :: bases(:)
   integer :: counts(is_refused:stops), i, n_faults
   integer(lk) :: number
   type(error_t), allocatable :: error

   allocate (bases(command_argument_count() - 3))
   do i = 1, size(bases)
      call load_base(text_argument(3 + i), bases(i))
   end do
   counts = 0
   n_faults = 0
   do number = integer_argument(1), integer_argument(2)
      call try_one(number, mod(number, int(integer_argument(3), lk)) == 0_lk)
   end do
   print "(5(i0,a),i0,a)", counts(is_refused), " refused, ", counts(has_error), " errors, ", &
      counts(is_loaded), " loaded, ", counts(goes_on), " go on, ", counts(stops), " stop, ", &
      n_faults, " faults"
   if (n_faults > 0) error stop 1, quiet = .true.

contains

   !> Read a run's scene and checkpoint; find the entries of the state.
   subroutine load_base(folder, base)
      character(len=*), intent(in) :: folder
      type(base_t), intent(out) :: base
      type(entry_t) :: entry
      integer(lk) :: at, extent, n
      integer(ik) :: i, length
      logical :: has_begun

      call read_scene(folder//"/scene.nml", base%scene, error)
      call stop_on(error)
      call read_bytes(folder//"/checkpoint.bin", base%bytes)
      base%bytes = base%bytes(head_size + 1:)
      allocate (base%entries(0))
      has_begun = .false.
      at = 0_lk
      do while (at < size(base%bytes, kind=lk))
         length = transfer(base%bytes(at + 1:at + 4), length)
         entry%name = repeat(" ", 32)
         entry%name(:length) = transfer(base%bytes(at + 5:at + 4 + length), entry%name(:length))
         if (entry%name == "simulation" .and. .not. has_begun) then
            has_begun = .true.
            base%bytes = base%bytes(at + 1:)
            at = 0_lk
         end if
         entry%kind = transfer(base%bytes(at + 5 + length:at + 6 + length), entry%kind)
         entry%rank_at = at + 7 + length
         entry%ranks = transfer(base%bytes(entry%rank_at:entry%rank_at + 3), entry%ranks)
         entry%values_at = entry%rank_at + 4
         n = merge(0_lk, bytes_of(entry%kind), entry%ranks < 0)
         do i = 1, entry%ranks
            extent = transfer(base%bytes(entry%values_at:entry%values_at + 7), extent)
            n = n*extent
            entry%values_at = entry%values_at + 8
         end do
         entry%last = entry%values_at + n - 1
         at = entry%last
         if (has_begun .and. entry%kind /= "g0") base%entries = [base%entries, entry]
      end do
   end subroutine load_base

   !> Bytes of a value.
   pure integer(lk) function bytes_of(kind)
      character(len=2), intent(in) :: kind

      select case (kind)
      case ("r8", "i8", "n8")
         bytes_of = 8_lk
      case ("i4", "l4")
         bytes_of = 4_lk
      case ("g0")
         bytes_of = 0_lk
      case default
         bytes_of = 1_lk
      end select
   end function bytes_of

   !> Load one in a separate process.
   subroutine try_one(number, may_go_on)
      integer(lk), intent(in) :: number
      logical, intent(in) :: may_go_on
      type(random_t) :: random
      character(len=:), allocatable :: what
      integer(int8), allocatable :: bytes(:)
      integer(c_int) :: id, status
      integer :: b, code

      call random%start(number)
      b = 1 + random%below(size(bases))
      call mutate(bases(b), random, bytes, what)
      flush (output_unit)
      flush (error_unit)
      id = fork()
      if (id == 0_c_int) then
         status = alarm(time_limit)
         call leave(int(outcome(bases(b)%scene, bytes, may_go_on), c_int))
      end if
      id = waitpid(id, status, 0_c_int)
      code = ishft(int(status), -8)
      if (iand(int(status), 127) == 0 .and. code >= is_refused .and. code <= stops) then
         counts(code) = counts(code) + 1
      else
         n_faults = n_faults + 1
         write (error_unit, "(2(a,i0),4a)") "fault ", number, ": status ", status, ", ", &
            text_argument(3 + b), ": ", what
      end if
   end subroutine try_one

   !> The state with one or two changes, and these in words.
   subroutine mutate(base, random, bytes, what)
      type(base_t), intent(in) :: base
      type(random_t), intent(inout) :: random
      integer(int8), allocatable, intent(out) :: bytes(:)
      character(len=:), allocatable, intent(out) :: what
      type(entry_t) :: entry
      integer :: changes(2), i, n

      n = 1 + merge(1, 0, random%below(4) == 0)
      changes = [(1 + random%below(size(base%entries)), i=1, 2)]
      if (n == 2 .and. changes(1) == changes(2)) n = 1
      ! The last one first: its change moves nothing before it.
      if (n == 2) changes = [maxval(changes), minval(changes)]
      bytes = base%bytes
      what = ""
      do i = 1, n
         entry = base%entries(changes(i))
         call change(entry, random, bytes, what)
      end do
   end subroutine mutate

   !> Change a value or a byte of an entry, or remove all its values, or the last ones, or add some.
   subroutine change(entry, random, bytes, what)
      type(entry_t), intent(in) :: entry
      type(random_t), intent(inout) :: random
      integer(int8), allocatable, intent(inout) :: bytes(:)
      character(len=:), allocatable, intent(inout) :: what
      integer(lk) :: extent, n, slice
      integer :: how

      how = random%below(8)
      extent = 0_lk
      if (entry%ranks > 0) extent = transfer(bytes(entry%values_at - 8:entry%values_at - 1), extent)
      n = entry%last - entry%values_at + 1
      slice = 0_lk
      if (extent > 0_lk) slice = n/extent
      if (how == 0 .and. entry%ranks > 0) then
         what = what//"none of "
         bytes = [bytes(:entry%rank_at - 1), transfer(-1_ik, bytes, 4), bytes(entry%last + 1:)]
      else if (how == 1 .and. slice > 0_lk) then
         what = what//"fewer of "
         bytes = [bytes(:entry%values_at - 9), transfer(extent - 1_lk, bytes, 8), &
                  bytes(entry%values_at:entry%last - slice), bytes(entry%last + 1:)]
      else if (how == 2 .and. slice > 0_lk) then
         what = what//"more of "
         bytes = [bytes(:entry%values_at - 9), transfer(extent + 1_lk, bytes, 8), &
                  bytes(entry%values_at:entry%last), bytes(entry%last - slice + 1:)]
      else if (how == 3 .and. n > 0_lk) then
         what = what//"a byte of "
         slice = entry%values_at + random%below(int(n))
         bytes(slice) = int(random%below(256) - 128, int8)
      else if (n > 0_lk) then
         what = what//"a value of "
         call replace(entry, random, bytes(entry%values_at:entry%last))
      end if
      what = what//trim(entry%name)//" "
   end subroutine change

   !> Give one of the values of an entry another value.
   subroutine replace(entry, random, values)
      type(entry_t), intent(in) :: entry
      type(random_t), intent(inout) :: random
      integer(int8), intent(inout) :: values(:)
      integer(ik), parameter :: wrong(7) = [0_ik, -1_ik, 1_ik, 2_ik, 1000_ik, huge(1_ik), &
                                            -huge(1_ik)]
      ! 0, -1, 1e300, nan, inf and the smallest one
      integer(lk), parameter :: wrong_reals(6) = &
                                [0_lk, int(z"BFF0000000000000", lk), int(z"7E37E43C8800759C", lk), &
                                 int(z"7FF8000000000000", lk), int(z"7FF0000000000000", lk), 1_lk]
      integer :: at, n

      n = int(bytes_of(entry%kind))
      if (n == 1) n = 4  ! a part of a type
      if (size(values) < n) n = 1
      at = n*random%below(size(values)/n)
      if (n == 8 .and. entry%kind == "r8") then
         values(at + 1:at + n) = transfer(wrong_reals(1 + random%below(6)), values, n)
      else
         values(at + 1:at + n) = transfer(int(wrong(1 + random%below(7)), lk), values, n)
      end if
   end subroutine replace

   !> Load a state, and perhaps go on to the next one.
   integer function outcome(scene, bytes, may_go_on)
      type(scene_t), intent(in) :: scene
      integer(int8), intent(in) :: bytes(:)
      logical, intent(in) :: may_go_on
      type(two_levels_t), allocatable :: levels
      type(mechanics_simulation_t), allocatable :: body

      if (scene%has_fluid()) then
         allocate (levels)
         outcome = outcome_of(levels, scene, bytes, may_go_on)
      else
         allocate (body)
         outcome = outcome_of(body, scene, bytes, may_go_on)
      end if
   end function outcome

   integer function outcome_of(simulation, scene, bytes, may_go_on) result(outcome)
      class(restartable_t), intent(inout) :: simulation
      type(scene_t), intent(in) :: scene
      integer(int8), intent(in) :: bytes(:)
      logical, intent(in) :: may_go_on
      type(archive_t) :: archive
      type(timers_t) :: timers

      archive%bytes = bytes
      archive%length = size(bytes, kind=lk)
      call archive%begin_loading()
      call timers%begin()
      call simulation%prepare(scene)
      call simulation%visit(archive, timers, error)
      outcome = has_error
      if (allocated(error)) return
      outcome = is_refused
      if (allocated(archive%fault) .or. archive%place /= archive%length) return
      outcome = is_loaded
      if (.not. may_go_on .or. simulation%is_over()) return
      call simulation%next_state(timers, error)
      if (.not. allocated(error)) call simulation%grow(timers, error)
      outcome = merge(stops, goes_on, allocated(error))
   end function outcome_of

end program mutated_checkpoints
