!> Ways of wells at points of fractures to the cells and joints that they supply, with what is taken
!! up on the way (coarse_well_ways), and their shares next to joints.
module twolevel_well_ways
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use coarse_joints, only: joints_t
   use coarse_model, only: coarse_model_t
   use coarse_well_ways, only: effective_s, uptake_t
   use mesh_types, only: mesh_t
   use scene_outline, only: sides_of_scene
   use scene_sides, only: boundary_side_t
   use scene_types, only: injection_t, scene_t
   implicit none(type, external)
   private

   public :: find_outlet_ways, find_way

contains

   !> Way and shares of a well of one entry in the step that ends at a time.
   pure subroutine find_way(well, steady, model, mesh, conductance, time, share, joint_share, path)
      type(injection_t), intent(in) :: well
      real(rk), intent(in) :: steady(:)  !< (fracture cells) of place_wells [-]
      type(coarse_model_t), intent(in) :: model
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: conductance(:)  !< (fracture cells) [m3/(Pa s)]
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(inout) :: share(:), path(:)  !< (fracture cells) [-]
      real(rk), intent(inout) :: joint_share(:)  !< (joints) [-]
      real(rk) :: age, unused
      type(uptake_t) :: uptake
      integer(ik) :: cell, joint
      logical :: around(size(steady))

      age = time - max(0.0_rk, well%stage_start(1_ik))
      if (well%fracture == 0 .or. .not. (well%at_point .and. age > 0.0_rk)) return
      around = steady > 0.0_rk
      cell = maxloc(merge(steady, 0.0_rk, share > 0.0_rk), dim=1, kind=ik)
      uptake = uptake_at(model, mesh, conductance, cell, around)
      call uptake%find(effective_s(age, well%has_given_flow()), 1.0_rk - steady(cell))
      joint = findloc(joint_share > 0.0_rk, .true., dim=1, kind=ik)
      if (joint > 0) then
         call uptake%way_at_end(steady(cell), &
                                other_branches(model%joints, joint, cell, conductance), .true., &
                                path(cell), joint_share(joint))
         share(cell) = 1.0_rk - joint_share(joint)
      else if (count(around) == 1 .and. steady(cell) > same_value) then
         call uptake%way_at_end(steady(cell), 0.0_rk, .false., path(cell), unused)
      else
         ! In the middle of a cell the way is one in half of it.
         where (around) path = merge(1.0_rk, 2.0_rk, count(around) > 1)*uptake%way(steady)
      end if
   end subroutine find_way

   !> What the rock takes up at a cell and those around it.
   pure function uptake_at(model, mesh, conductance, cell, around) result(uptake)
      type(coarse_model_t), intent(in) :: model
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: conductance(:)  !< (fracture cells) [m3/(Pa s)]
      integer(ik), intent(in) :: cell
      logical, intent(in) :: around(:)  !< (fracture cells) that conductance and length are means of
      type(uptake_t) :: uptake
      integer(ik) :: i

      associate (s => mesh%fracture%cell_s, &
                 sides => mesh%face_cells(1, mesh%fracture%cell_faces(:, cell)))
         uptake%conductance = count(around)/sum(1.0_rk/conductance, mask=around)
         uptake%length = sum(s(2, :) - s(1, :), mask=around)/count(around)
         uptake%mobility = [(model%rock%mobility_at(sides(i)), i=1, 2)]
         uptake%diffusivity = [(model%rock%diffusivity_at(sides(i)), i=1, 2)]
      end associate
      if (allocated(model%cells%skin)) uptake%skin = model%cells%skin(cell)
   end function uptake_at

   !> Ways of the branches to outlets, in a step from a time on. Each change of the side's pressure
   !! has the way of its age, for the mean flow within the step; flow that is not due to these has
   !! the mean of these ways, or that which a well next to the side has.
   pure subroutine find_outlet_ways(model, mesh, scene, conductance, time, dt, has_well)
      type(coarse_model_t), intent(inout) :: model
      type(mesh_t), intent(in) :: mesh
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: conductance(:)  !< (fracture cells) [m3/(Pa s)]
      real(rk), intent(in) :: time, dt  !< [s]
      logical, intent(in) :: has_well(:)  !< (fracture cells)
      real(rk), allocatable :: age(:), change(:), error(:), fall(:), flow(:), lost(:), way(:)
      type(boundary_side_t), allocatable :: sides(:)
      type(uptake_t) :: uptake
      integer(ik) :: b, i

      if (.not. any(model%joints%is_outlet)) return
      sides = sides_of_scene(scene)
      do b = 1, model%joints%branch_count()
         associate (joints => model%joints, cell => model%joints%cell(b), &
                    joint => model%joints%joint(b))
            if (.not. joints%is_outlet(joint)) cycle
            uptake = uptake_at(model, mesh, conductance, cell, &
                               [(i == cell, i=1, size(has_well, kind=ik))])
            call sides(joints%side(joint))%pressure_changes(scene%initial%pressure, time + dt, &
                                                            age, change)
            way = age
            error = age
            flow = age
            fall = age
            do i = 1, size(age, kind=ik)
               call uptake%way_of_outlet(age(i), way(i), error(i), flow(i), fall(i))
            end do
            joints%way(b) = way(1)
            joints%way_error(b) = error(1)
            ! The pressure between side and cell, which has at most that of the side.
            lost = change*min(1.0_rk, flow*way)
            ! Where little of it is lost within the cell, others decide how the flow falls.
            fall = 1.0_rk - min(0.5_rk, max(0.0_rk, fall))*min(1.0_rk, flow*way)
            flow = flow*change*age/fall
            joints%gross(b) = 2.0_rk*conductance(cell)/uptake%length*sum(abs(flow))
            flow = flow*(1.0_rk - max(0.0_rk, 1.0_rk - dt/age)**fall)/dt
            if (any(abs(flow) > 0.0_rk)) then
               joints%way(b) = sum(abs(lost))/sum(abs(flow))
               joints%way_error(b) = sum(abs(flow)*error)/sum(abs(flow))
            end if
            if (has_well(cell)) joints%way(b) = 1.0_rk
            joints%excess(b) = sum(joints%way(b)*flow - lost)
         end associate
      end do
   end subroutine find_outlet_ways

   !> What the branches of a joint take up by its pressure, over what that of one cell does: as the
   !! roots of their conductances. The side of an outlet takes up all [-].
   pure real(rk) function other_branches(joints, joint, cell, conductance) result(others)
      type(joints_t), intent(in) :: joints
      integer(ik), intent(in) :: joint, cell
      real(rk), intent(in) :: conductance(:)  !< (fracture cells) [m3/(Pa s)]

      others = huge(1.0_rk)
      if (joints%is_outlet(joint)) return
      others = sum(sqrt(conductance(joints%cell)/conductance(cell)), &
                   mask=joints%joint == joint .and. joints%cell /= cell .and. .not. joints%is_shut)
   end function other_branches

end module twolevel_well_ways
