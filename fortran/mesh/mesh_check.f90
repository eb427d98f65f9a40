!> Whether a body and its fractures can be meshed, judged by the C++ library without meshing.
module mesh_check
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use mesh_c_binding, only: cm_check, cm_joint_t, cm_network_t, cm_spec_t
   use mesh_c_inputs, only: c_network_arrays_t, mesh_spec_t, prepare_network, prepare_spec
   use mesh_faults, only: fault_t, last_fault
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: check_mesh_input, joint_t

   !> A place inside the body where fractures meet.
   type :: joint_t
      integer(ik) :: fractures(2) = 0  !< twice the same one that meets itself
      real(rk) :: xy(2) = 0.0_rk  !< [m]
   end type joint_t

contains

   !> Judge what build_mesh would mesh, by the same code.
   subroutine check_mesh_input(spec, network, joints, fault)
      type(mesh_spec_t), intent(in) :: spec
      type(network_t), intent(in) :: network
      type(joint_t), allocatable, intent(out) :: joints(:)  !< none if there is a fault
      type(fault_t), allocatable, intent(out) :: fault  !< unallocated: it can be meshed
      type(error_t), allocatable :: error
      type(cm_spec_t) :: c_spec
      type(cm_network_t) :: c_network
      type(mesh_spec_t), target :: kept
      type(c_network_arrays_t), target :: arrays
      type(cm_joint_t), allocatable :: found(:)
      integer(ik) :: i, n

      kept = spec
      allocate (joints(0), found(0))
      call prepare_network(network, arrays, c_network, error)
      if (.not. allocated(error)) call prepare_spec(kept, c_network%n_fractures, c_spec, error)
      if (allocated(error)) then
         fault = fault_t(reason=error%message)
         allocate (fault%culprits(0))
         return
      end if
      if (cm_check(c_spec, c_network, 0_ik, found, n) /= 0) then
         fault = last_fault()
         return
      end if
      if (n == 0) return
      deallocate (found, joints)
      allocate (found(n), joints(n))
      if (cm_check(c_spec, c_network, n, found, n) /= 0) then
         fault = last_fault()
         return
      end if
      do i = 1, n
         joints(i) = joint_t(fractures=found(i)%fracture + 1, xy=[found(i)%x, found(i)%y])
      end do
   end subroutine check_mesh_input

end module mesh_check
