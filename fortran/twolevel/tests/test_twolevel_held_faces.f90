!> Faces that are held have the solution of the law of contact: on a network with a joint, in which
!! one fracture slides and the others stick, and under a load that lets held faces slide.
program test_twolevel_held_faces
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use contact_law, only: contact_law_t, state_stick
   use fine_boundary, only: add_side_traction, fine_boundary_t, free_boundary, nearest_node
   use fine_contact, only: contact_t, new_contact
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_contact, face_jump, faces_at_joints, &
                         loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use testing_checks, only: checks_t
   use twolevel_faces, only: face_map_t
   use twolevel_held_faces, only: choose_held, hold_faces, release_faces
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   real(rk), parameter :: half = 3.0_rk
   type(checks_t) :: checks
   type(fine_model_t) :: model
   type(fine_boundary_t) :: boundary
   type(mesh_t) :: mesh
   type(face_map_t) :: map
   type(contact_law_t), allocatable :: law(:)
   logical, allocatable :: held(:)

   call set_body()
   call compare_under(2.0e6_rk, .false.)
   call compare_under(5.0e6_rk, .true.)
   call checks%finish()

contains

   !> Two fractures that cross, and a third one without friction.
   subroutine set_body()
      type(network_t) :: network
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(error_t), allocatable :: error
      integer(ik) :: i

      network = network_t(first=[1_ik, 3_ik, 5_ik, 7_ik], s_start=spread(0.0_rk, 1, 3), &
                          xy=reshape([-1.8_rk, 0.1_rk, 1.5_rk, 0.3_rk, &
                                      0.1_rk, 1.5_rk, 0.4_rk, -1.5_rk, &
                                      -1.0_rk, -2.0_rk, -0.4_rk, -1.5_rk], [2, 6]))
      spec%x_min = -half
      spec%x_max = half
      spec%y_min = -half
      spec%y_max = half
      spec%size_fracture = 0.1_rk
      spec%size_boundary = 0.8_rk
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%no_error(error, "network is meshed")
      call model%set_mesh(mesh, elasticity_t(70.0e9_rk, 0.21_rk, 0.0_rk, .false.), error)
      call checks%no_error(error, "network is numbered")
      boundary = free_boundary(model%mesh)
      boundary%prescribed(:, nearest_node(model%mesh, [-half, -half])) = .true.
      boundary%prescribed(2, nearest_node(model%mesh, [half, -half])) = .true.
      ! The coarse level has the same fracture cells here.
      associate (fracture => mesh%fracture)
         map%coarse_cell = [(i, i=1, fracture%n_cells)]
         allocate (map%is_inside(fracture%n_cells), source=.true.)
         law = merge(contact_law_t(0.0_rk), contact_law_t(0.6_rk), fracture%cell_fracture == 3)
      end associate
   end subroutine set_body

   !> Contact of all faces against contact of those that are not held.
   subroutine compare_under(shear, slides)
      real(rk), intent(in) :: shear  !< [Pa]
      logical, intent(in) :: slides  !< the load is one under which held faces slide
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: all_in_contact, conditions
      type(contact_t) :: contact
      type(state_t) :: state
      type(window_tip_t) :: no_tips(0)
      type(error_t), allocatable :: error
      real(rk), allocatable :: exact(:, :), displacement(:, :)
      logical :: again
      integer :: releases

      all_in_contact = loaded_everywhere(model%mesh)
      all_in_contact%condition = face_contact
      all_in_contact%law%contact = law
      loads = no_loads(model%mesh)
      call add_side_traction(model%mesh, 1_ik, [8.0e6_rk, -shear], loads%force)
      call add_side_traction(model%mesh, 2_ik, [-8.0e6_rk, shear], loads%force)
      call add_side_traction(model%mesh, 3_ik, [-shear, 8.0e6_rk], loads%force)
      call add_side_traction(model%mesh, 4_ik, [shear, -8.0e6_rk], loads%force)
      call model%prepare(all_in_contact, error, boundary)
      call checks%no_error(error, "all in contact")
      contact = new_contact(model%mesh)
      call model%solve(loads, exact, error, contact)
      call checks%no_error(error, "all in contact, solved")

      contact = new_contact(model%mesh)
      if (.not. allocated(held)) then
         call see_state(exact, loads, state)
         held = choose_held(model%mesh, map, mesh, law, state, contact%slip_before, no_tips)
         call checks%is_true(2*count(held) > size(held), "most faces are held")
         call checks%is_true(.not. any(held .and. (faces_at_joints(model%mesh) .or. &
                                                   mesh%fracture%cell_fracture == 3)), &
                             "none at joints, none that slides")
      end if
      releases = 0
      do
         conditions = all_in_contact
         where (held) conditions%condition = face_jump
         call hold_faces(held, contact, conditions%law, loads)
         call model%prepare(conditions, error, boundary)
         call checks%no_error(error, "some held")
         call model%solve(loads, displacement, error, contact)
         call checks%no_error(error, "some held, solved")
         call release_faces(model, loads, displacement, mesh, map, held, again)
         if (.not. again) exit
         releases = releases + 1
      end do
      call checks%is_true(slides .eqv. releases > 0, "faces are released where they slide")
      call checks%is_close(maxval(abs(displacement - exact)), 0.0_rk, &
                           1.0e-9_rk*maxval(abs(exact)), "displacement as by the law [m]")
   end subroutine compare_under

   !> State of the coarse level with the tractions of a solution.
   subroutine see_state(displacement, loads, state)
      use fine_tip_domain, only: face_traction
      real(rk), intent(in) :: displacement(:, :)  !< [m]
      type(fine_loads_t), intent(in) :: loads
      type(state_t), intent(out) :: state
      real(rk) :: traction(2)
      integer(ik) :: i

      associate (n => mesh%fracture%n_cells)
         allocate (state%traction(2, 2, n), source=0.0_rk)
         allocate (state%contact(2, n), source=state_stick)
         do i = 1, n
            traction = face_traction(model, loads, displacement, i)
            associate (tau => model%mesh%face_tangent(:, i))
               state%traction(1, :, i) = tau(1)*traction(2) - tau(2)*traction(1)
               state%traction(2, :, i) = dot_product(tau, traction)
            end associate
         end do
      end associate
   end subroutine see_state

end program test_twolevel_held_faces
