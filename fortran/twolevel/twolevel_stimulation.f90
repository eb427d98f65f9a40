!> Effects of an injection on the fractures: the distribution of its fluid, the faces that have
!! moved since the start, and the fractures connected with the wells.
!!
!! Faces are stimulated if they have slipped or opened since the start, at any time, by more than a
!! length of the scene (`stimulated_jump`); new faces are always stimulated. Connected are the
!! fractures that fluid reaches from the wells without leaving the fractures: each conducts at least
!! with its residual aperture, and a joint conducts once the crack has reached it. Both are resolved
!! to one cell.
!!
!! Injectivity is the rate of the wells divided by the rise of their mean pressure above the initial
!! pressure of the surrounding rock, as in the injectivity index of a well; per metre of thickness.
module twolevel_stimulation
   use base_archive, only: archive_t
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use growth_front, only: front_state_t
   use growth_network, only: fracture_length, total_length
   use mesh_types, only: fracture_mesh_t, network_t
   use report_rows, only: history_row_t
   use scene_regime, only: dimensionless_leakoff, dimensionless_toughness
   use mesh_archive, only: visit_fracture_mesh
   use scene_types, only: scene_t
   use twolevel_places, only: end_at_tips
   use twolevel_reach, only: cluster_count, connections_per_branch, reached_cells, intervals_t
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)
   private

   public :: stimulation_t

   !> Stimulated faces, and sums since the start.
   type :: stimulation_t
      type(intervals_t), private :: faces  !< faces of the scene's fractures that have moved
      type(fracture_mesh_t), private :: fracture  !< fracture cells at the start
      !> (2, cells) jump at the start, normal and tangential [m]
      real(rk), allocatable, private :: jump(:, :)
      real(rk), private :: rock_pressure = 0.0_rk  !< pressure around the wells at the start [Pa]
      !> fluid volume in the fractures at the start [m2]
      real(rk), private :: fracture_volume = 0.0_rk
      real(rk), private :: content = 0.0_rk  !< fluid content of the rock at the start [m2]
      !> fluid added to the fractures by compression of the fluid [m2]
      real(rk), private :: compressed = 0.0_rk
      real(rk), private :: rock_outflow = 0.0_rk  !< outflow from the rock [m2]
   contains
      procedure :: begin
      procedure :: follow
      procedure :: describe
      procedure :: visit
   end type stimulation_t

contains

   !> Store the present state as that before the injection.
   subroutine begin(self, problem, state)
      class(stimulation_t), intent(out) :: self
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state

      call self%faces%clear()
      self%fracture = problem%mesh%fracture
      self%content = sum(state%content)
      if (self%fracture%n_cells == 0) return
      self%jump = mean_jump(state)
      self%fracture_volume = problem%fracture_volume(state)
      self%rock_pressure = pressure_around_wells(problem, state)
   end subroutine begin

   !> Update with an accepted step.
   subroutine follow(self, start, fracture, state, least_jump, compressed, rock_outflow)
      class(stimulation_t), intent(inout) :: self
      type(network_t), intent(in) :: start  !< initial network
      type(fracture_mesh_t), intent(in) :: fracture
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: least_jump  !< smallest jump of stimulated faces [m]
      real(rk), intent(in) :: compressed, rock_outflow  !< fluid volumes of the step [m2]
      real(rk), allocatable :: jump(:, :)
      real(rk) :: whole
      integer(ik) :: i

      self%compressed = self%compressed + compressed
      self%rock_outflow = self%rock_outflow + rock_outflow
      if (fracture%n_cells == 0) return
      jump = mean_jump(state)
      do i = 1, fracture%n_cells
         associate (f => fracture%cell_fracture(i), s => fracture%cell_s(:, i))
            if (.not. moved_by(self, f, s, jump(:, i)) > least_jump) cycle
            whole = fracture_length(start, f)
            call self%faces%add(f, [max(s(1), 0.0_rk), min(s(2), whole)])
         end associate
      end do
   end subroutine follow

   !> Slip or opening of a cell since the start; 0 where there was no fracture [m].
   pure real(rk) function moved_by(self, f, s, jump)
      type(stimulation_t), intent(in) :: self
      integer(ik), intent(in) :: f  !< fracture
      real(rk), intent(in) :: s(2)  !< arc lengths of the cell's ends [m]
      real(rk), intent(in) :: jump(2)  !< present jump [m]
      integer(ik) :: i

      moved_by = 0.0_rk
      associate (then => self%fracture, middle => 0.5_rk*sum(s))
         do i = 1, then%n_cells
            if (then%cell_fracture(i) /= f) cycle
            if (middle < then%cell_s(1, i) .or. middle > then%cell_s(2, i)) cycle
            moved_by = max(abs(jump(2) - self%jump(2, i)), jump(1) - self%jump(1, i))
            return
         end do
      end associate
   end function moved_by

   !> Fill in the columns of a row of history.csv, in which the rate of injection is set.
   pure subroutine describe(self, scene, start, front, problem, state, row)
      class(stimulation_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start  !< initial network
      type(front_state_t), intent(in) :: front
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(history_row_t), intent(inout) :: row
      type(fracture_mesh_t) :: fracture
      real(rk), parameter :: factor = 2.0_rk  ! to which a small jump is known
      real(rk), allocatable :: jump(:, :), length(:)
      logical, allocatable :: all_pass(:), is_connected(:), is_stimulated(:)
      real(rk) :: rise
      integer(ik) :: i

      row%rock_fluid = sum(state%content) - self%content
      row%rock_outflow = self%rock_outflow
      if (size(row%well_pressure) > 0) then
         associate (rate => row%injection_rate)
            row%dimensionless_toughness = &
               dimensionless_toughness(scene, scene%material%toughness, rate)
            row%dimensionless_leakoff = &
               dimensionless_leakoff(scene, maxval(row%well_pressure) - scene%initial%pressure, &
                                     rate, row%time)
         end associate
      end if
      fracture = problem%mesh%fracture
      if (fracture%n_cells == 0) return
      row%fracture_fluid = row%fracture_volume - self%fracture_volume + self%compressed
      call end_at_tips(scene, front, fracture)
      row%n_clusters = cluster_count(fracture)
      row%connections_per_branch = connections_per_branch(fracture)
      row%stimulated_length = self%faces%length() + total_length(front%network) &
                              - total_length(start)
      length = fracture%cell_s(2, :) - fracture%cell_s(1, :)
      jump = mean_jump(state)
      do i = 1, fracture%n_cells
         associate (moved => moved_by(self, fracture%cell_fracture(i), &
                                      problem%mesh%fracture%cell_s(:, i), jump(:, i)), &
                    least => scene%output%stimulated_jump)
            if (max(moved, least) > factor*min(moved, least)) cycle
            row%doubtful_length = row%doubtful_length + length(i)
         end associate
      end do
      if (size(scene%injections) == 0) return
      if (size(scene%injections) == 1 .and. all(scene%injections%fracture > 0)) then
         rise = row%well_pressure(1) - self%rock_pressure
         if (rise > 0.0_rk) row%injectivity = row%injection_rate/rise
      end if
      is_stimulated = [(counts(self, start, fracture%cell_fracture(i), &
                               0.5_rk*sum(problem%mesh%fracture%cell_s(:, i))), &
                        i=1, fracture%n_cells)]
      allocate (all_pass(fracture%n_cells), source=.true.)
      is_connected = reached_cells(fracture, fed_cells(problem, fracture), all_pass)
      row%connected_length = sum(length, mask=is_connected)
      row%connected_stimulated = sum(length, mask=is_connected .and. is_stimulated)
   end subroutine describe

   !> Whether a point of a fracture is stimulated: its faces have moved, or are new.
   pure logical function counts(self, start, f, s)
      type(stimulation_t), intent(in) :: self
      type(network_t), intent(in) :: start  !< initial network
      integer(ik), intent(in) :: f  !< fracture
      real(rk), intent(in) :: s  !< arc length [m]

      counts = s < 0.0_rk .or. s > fracture_length(start, f) .or. self%faces%covers(f, s)
   end function counts

   !> Whether each cell is supplied by wells, directly or through a joint.
   pure function fed_cells(problem, fracture) result(is_fed)
      type(coarse_problem_t), intent(in) :: problem
      type(fracture_mesh_t), intent(in) :: fracture  !< the last cells end at the tips
      logical, allocatable :: is_fed(:)
      integer(ik) :: j

      is_fed = sum(problem%share, dim=2) > 0.0_rk
      do j = 1, problem%model%joints%n
         if (.not. sum(problem%joint_share(j, :)) > 0.0_rk) cycle
         is_fed(fracture%point_cells%of(problem%model%joints%point(j))) = .true.
      end do
   end function fed_cells

   !> Mean jump of each cell: normal, tangential [m].
   pure function mean_jump(state) result(jump)
      type(state_t), intent(in) :: state
      real(rk) :: jump(2, size(state%pressure))

      jump = 0.5_rk*sum(state%jump, dim=2)
   end function mean_jump

   !> Mean pore pressure of the triangles along the fracture cells that wells supply [Pa].
   pure real(rk) function pressure_around_wells(problem, state) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      logical :: is_fed(problem%mesh%fracture%n_cells)
      real(rk) :: rock(problem%mesh%n_cells)  ! [Pa]
      integer(ik) :: i, side

      pressure = 0.0_rk
      rock = problem%rock_pressure(state)
      associate (mesh => problem%mesh)
         is_fed = fed_cells(problem, mesh%fracture)
         do i = 1, mesh%fracture%n_cells
            if (.not. is_fed(i)) cycle
            do side = 1, 2
               associate (cell => mesh%face_cells(1, mesh%fracture%cell_faces(side, i)))
                  pressure = pressure + 0.5_rk*rock(cell)
               end associate
            end do
         end do
      end associate
      pressure = pressure/max(count(is_fed), 1)
   end function pressure_around_wells

   !> Store or load all components.
   subroutine visit(self, archive)
      class(stimulation_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%list("faces_fracture", self%faces%fracture, "stimulated; 1:fractures")
      call archive%list("faces_s", self%faces%s, "2, stimulated")
      call visit_fracture_mesh(archive, "fracture", self%fracture)
      call archive%list("jump", self%jump, "2, own_cells")
      call archive%item("rock_pressure", self%rock_pressure)
      call archive%item("fracture_volume", self%fracture_volume)
      call archive%item("content", self%content)
      call archive%item("compressed", self%compressed)
      call archive%item("rock_outflow", self%rock_outflow)
   end subroutine visit

end module twolevel_stimulation
